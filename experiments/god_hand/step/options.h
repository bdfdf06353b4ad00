#pragma once

#include <array>
#include <string>

#include <zwang/core/problem/range.h>

namespace zwang::god {

inline constexpr double closed_within = 1e-9;  // m and rad: what joints and limits are kept to

// The choices of a run; the defaults are the project's, the others are the paper's or an experiment's.
struct Options {
  double dt = 1e-3;                                                 // s, a simulated step
  std::string solver = {};                                          // with settings: "nnls:reduce=on"; "": chosen by mu
  double tolerance = 1e-10;                                         // that it is asked for, and checked to
  std::string accuracy = {};                                        // that will do, "1e-4m/s" or "1e-4"; "": none
  double mu = 0.8;                                                  // of god objects on objects; 0: no friction
  enum class Friction { coulomb, convex } law = Friction::coulomb;  // how friction is read (core/problem/types.h)
  enum class Limits { predictive, violated } limits = Limits::predictive;  // violated: the paper's rows
  enum class Commit { cycle, printed } commit = Commit::cycle;  // printed: the linear step alone; joints open
  bool toc_twice = false;                                       // Eq. 29-30 as printed
  bool toc_of_all = false;                          // the smallest TOC of all clusters for every one (Algorithm 1)
  enum class Rows { near, met } rows = Rows::near;  // met: what the sweep ran into, with c = 0
  bool correct_drift = true;           // joints and limits get the c that mends what they are off; false: c = 0
  bool straight = true;                // where no contact presses, the targets themselves in place of the linear step
  bool damped = true, bounded = true;  // linear steps shortened by curvature; and to what contacts are looked for in
  bool clusters = true;                // each hand solved apart; false: as one problem
  bool hands_meet = true;  // two hands are one cluster while they are near; false: they pass through each other
  bool reduce_contacts = true, lazy_contacts = true;
  bool maximal = false;                  // no reduction of the equality rows, no islands, where the solver can
  double force_stiffness = -1;           // k_f [1/s^2]; below 0: chosen by mu
  double pads = 0;                       // N/m, of each contact with what is held; 0: hard
  double force_cap = 60;                 // N, a hand's push on one object
  double gap = 2e-4, activation = 2e-3;  // m: what contact rows keep; from where they are written
  double fastest = 8;                    // m/s: targets that go faster are no hand's, tracking has jumped
  double jump = 0.016;                   // m: targets that go farther in a frame have jumped, too
  double catch_up = 0.8;                 // m/s: a pressing hand may go so fast though its target does not
  int sub_steps = 3;
  int iterations = 100;  // that `cone` may take of a solve
  double budget = 0;     // ms of CPU time that the solves of a frame may take; 0: none
  bool measured = true;  // false: of a frame nothing but what a stream shows: poses, contacts, forces, held
  int verify = 20;       // the referee looks at the solves of every so-many-th frame (not in the times); 0: of none
};

// With what `mu` chooses filled in: solver and k_f. A hand that only pushes is soft; for one that holds, a finger tip
// of 20 g has to press with newtons over the thickness of a finger.
inline Options chosen(Options o) {
  if (o.solver.empty()) o.solver = o.mu > 0 ? "cone" : "dual_active_set";
  if (o.force_stiffness < 0) o.force_stiffness = o.mu > 0 ? 1e4 : 1000;
  return o;
}

// The method as the paper prints it: Eq. 6-11, 29 and 30 and Algorithm 1. Each choice may be taken back alone.
inline Options paper_method() {
  Options o;
  o.solver = "nnls_paper";
  o.mu = 0;
  o.limits = Options::Limits::violated;
  o.commit = Options::Commit::printed;
  o.toc_twice = o.toc_of_all = o.maximal = true;
  o.rows = Options::Rows::met;
  o.hands_meet = o.correct_drift = o.straight = o.damped = o.bounded = o.reduce_contacts = o.lazy_contacts = false;
  o.sub_steps = 1;
  return o;
}

// What people type and read for an option.
struct OptionText {
  const char* key;   // in run.json
  const char* name;  // --name; null: not typed as such
  const char* line;  // help
  Range range = {};  // of a number
};
// What is typed for the two values of a choice: of an enumeration in its order, of a bool false first.
using Words = std::array<const char*, 2>;

// Every option once, for the command line, for run.json and for what may be read back: visit(text, option), and
// visit(text, option, words) for a choice.
template <class SomeOptions, class Visit>
void each_option(SomeOptions& o, const Visit& visit) {
  visit(OptionText{"dt", nullptr, "", from_to(1e-5, 1, "s")}, o.dt);
  visit(OptionText{"solver", "solver", "NAME:k=v,...; default: cone, at --mu 0 dual_active_set (./zwang solvers)"},
        o.solver);
  visit(OptionText{"tolerance", "tolerance", "that the solver is asked for; default: 1e-10", from_to(1e-16, 1)},
        o.tolerance);
  visit(OptionText{"accuracy", "accuracy",
                   "a solve may end once a bound on its error is this, of any body or relative to the motion: 1e-4m/s, "
                   "1e-4; default: none"},
        o.accuracy);
  visit(OptionText{"mu", "mu", "friction; 0: none; default: 0.8, with --method paper none", from_to(0, 1024)}, o.mu);
  visit(OptionText{"law", "law", "how friction is read (docs/formulation.md)"}, o.law, Words{"coulomb", "convex"});
  visit(OptionText{"limits", "limits", "rows of joint limits before they are met, or once violated"}, o.limits,
        Words{"predictive", "violated"});
  visit(OptionText{"commit", "commit", "close the joints after each step, or the linear step alone"}, o.commit,
        Words{"cycle", "printed"});
  visit(OptionText{"toc_twice", "toc", "time of contact applied once, or as Eq. 29-30 are printed"}, o.toc_twice,
        Words{"once", "twice"});
  visit(OptionText{"toc_of_all", "toc-of", "whose time of contact ends a sub-step (all: Algorithm 1)"}, o.toc_of_all,
        Words{"cluster", "all"});
  visit(OptionText{"rows", "contacts", "rows of what is near, or of what was met, with c = 0"}, o.rows,
        Words{"near", "met"});
  visit(OptionText{"correct_drift", "drift", "c of joints and limits mends what they are off; off: c = 0"},
        o.correct_drift, Words{"off", "on"});
  visit(OptionText{"straight", "straight", "straight to the targets where no contact presses"}, o.straight,
        Words{"off", "on"});
  visit(OptionText{"damped", "damping", "steps shortened where joints bend them"}, o.damped, Words{"off", "on"});
  visit(OptionText{"bounded", "bounds", "steps kept within what contacts are looked for in"}, o.bounded,
        Words{"off", "on"});
  visit(OptionText{"clusters", "clusters", "each hand solved apart"}, o.clusters, Words{"off", "on"});
  visit(OptionText{"hands_meet", "hands", "hands that cross touch each other (not with --clusters off)"}, o.hands_meet,
        Words{"pass", "meet"});
  visit(OptionText{"reduce_contacts", "thinning", "contacts reduced to those that carry"}, o.reduce_contacts,
        Words{"off", "on"});
  visit(OptionText{"lazy_contacts", "lazy",
                   "what thinning took is given back where the solve needs it; off: all of it, at once"},
        o.lazy_contacts, Words{"off", "on"});
  visit(OptionText{"maximal", "model", "26 unknowns a hand, or 96 with 70 joint rows"}, o.maximal,
        Words{"reduced", "maximal"});
  visit(OptionText{"force_stiffness", "k-f", "stiffness of the coupling; default: 10,000, without friction 1,000",
                   from(0, "1/s^2")},
        o.force_stiffness);
  visit(OptionText{"pads", "pads", "stiffness of a soft finger pad, of each contact's normal row; 0: hard; default: 0",
                   from(0, "N/m")},
        o.pads);
  visit(OptionText{"force_cap", "cap", "largest push on one object; default: 60", from(0, "N")}, o.force_cap);
  visit(OptionText{"gap", "gap", "that contact rows keep; default: 2e-4", between(0, 0.01, "m")}, o.gap);
  visit(OptionText{"activation", "activation", "nearer contacts are rows; default: 2e-3", between(0, 0.1, "m")},
        o.activation);
  visit(OptionText{"fastest", "fastest", "targets that go faster have jumped; default: 8", above(0, "m/s")}, o.fastest);
  visit(OptionText{"jump", "jump", "and those that go farther in a frame; default: 0.016", between(0, 1, "m")}, o.jump);
  visit(OptionText{"catch_up", "catch-up", "speed of a pressing hand to a still target; default: 0.8", from(0, "m/s")},
        o.catch_up);
  visit(OptionText{"sub_steps", "sub-steps", "of a frame, at most; default: 3", from_to(1, 100)}, o.sub_steps);
  visit(OptionText{"iterations", "iterations",
                   "of cone, in a solve; what is not answered by then is of a simpler law, and the frame is limited; "
                   "default: 100",
                   from_to(1, 1e6)},
        o.iterations);
  visit(OptionText{"budget", "budget",
                   "CPU time that the solves of a frame may take, likewise; what no law has answered by then is not "
                   "done; 0: no limit; default: 0",
                   from(0, "ms")},
        o.budget);
  visit(OptionText{"verify", "verify", "the referee looks at every N-th frame, untimed; 0: none; default: 20", from(0)},
        o.verify);
}

}  // namespace zwang::god
