#include <zwang/experiments/questions/list.h>

#include <array>

namespace zwang::questions {

static const std::array all{
    Question{"fig8", "How many contacts are there, and what does a frame cost, in the simple scene?",
             "Fig. 8: above 600 Hz on average, at least 100 Hz", simple_scene},
    Question{"fig9", "Where does the time of a frame go?", "Fig. 9: about 40 % in collision detection", stages},
    Question{"fig10", "And in an engine compartment of a million triangles?",
             "Fig. 10: 50 to 70 Hz, below 20 Hz near detailed parts", engine},
    Question{"detailed", "And on parts of 400,000 triangles?", "Section 7: 10 to 15 Hz", detailed_parts},
    Question{"growth", "How does the time grow with the number of contacts?", "Section 7: linearly",
             growth_with_contacts},
    Question{"two-hands", "What do clusters buy when there are two hands?", "Section 7: a factor of 1.7", two_hands},
    Question{"thinning", "What do fewer contacts per body cost, and buy?",
             "Section 7: 'further potential for optimization'", thinning},
    Question{"separation", "Do the phalanxes come apart?", "Section 7: slightly, in some situations", separation},
    Question{"printed-step", "What do Eq. 29-30 do as printed, with the time of contact in both?", "Section 6.3",
             printed_step},
    Question{"solvers", "Does it matter which solver drives the hand?", "Section 4.1 uses NNLS (TSNNLS)", solver_swap},
    Question{"solvers-paper", "And where the rest is the paper's method, too?", "Section 4.1", solvers_of_the_paper},
    Question{"minimal", "What does it cost to model more than the scene needs?", "Section 5: clusters",
             no_more_than_needed},
    Question{"friction", "Does a hand stick to a frictionless plane?", "Section 7: no artificial friction",
             artificial_friction},
    Question{"rates", "Does the same push move a box equally at every rate?", "Section 6.2: forces are handed over",
             rate_of_a_push},
    Question{"laws", "What does a simpler law of friction cost?", "Section 7: friction is left out", laws_of_friction},
    Question{"recordings", "Do recorded hands stay out of the objects, whole and unstuck?",
             "Section 7: always non-penetrating", recordings},
};

std::span<const Question> questions() { return all; }

}  // namespace zwang::questions
