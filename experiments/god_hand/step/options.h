#pragma once

#include <array>
#include <limits>
#include <string>

namespace zwang::god {

// Targets that go faster are no hand's: tracking has jumped.
inline constexpr double fastest_hand = 8;  // m/s

// The choices of a run; the defaults are the project's, the others are the paper's or an experiment's.
struct Options {
  double dt = 1e-3;                                                 // s, a simulated step
  std::string solver = {};                                          // with settings: "nnls:reduce=on"; "": chosen by mu
  double tolerance = 1e-10;                                         // that it is asked for, and checked to
  double mu = 0.8;                                                  // of god objects on objects; 0: no friction
  enum class Friction { coulomb, convex } law = Friction::coulomb;  // how friction is read (core/problem/types.h)
  enum class Limits { predictive, violated } limits = Limits::predictive;  // violated: the paper's rows
  enum class Commit { cycle, printed } commit = Commit::cycle;  // printed: the linear step alone; joints open
  bool toc_twice = false;                                       // Eq. 29-30 as printed
  bool toc_of_all = false;  // the smallest TOC of all clusters for every one (Algorithm 1)
  bool clusters = true;     // each hand solved apart; false: as one problem
  bool reduce_contacts = true, lazy_contacts = true;
  bool maximal = false;                  // no reduction of the equality rows, no islands, where the solver can
  double force_stiffness = -1;           // k_f [1/s^2]; below 0: chosen by mu
  double force_cap = 60;                 // N, a hand's push on one object
  double gap = 2e-4, activation = 2e-3;  // m: what contact rows keep; from where they are written
  int sub_steps = 3;
  int verify = 10;  // the referee looks at the solves of every so-many-th frame (not in the times); 0: of none
};

// With what `mu` chooses filled in: solver and k_f. A hand that only pushes is soft; for one that holds, a finger tip
// of 20 g has to press with newtons over the thickness of a finger.
inline Options chosen(Options o) {
  if (o.solver.empty()) o.solver = o.mu > 0 ? "cone" : "dual_active_set";
  if (o.force_stiffness < 0) o.force_stiffness = o.mu > 0 ? 1e4 : 1000;
  return o;
}

inline constexpr double unbounded = std::numeric_limits<double>::infinity();

// What people type and read for an option.
struct OptionText {
  const char* key;                            // in run.json
  const char* name;                           // --name; null: not typed as such
  const char* line;                           // help
  double low = -unbounded, high = unbounded;  // its range
  bool open = false;                          // `low` itself is out
  bool holds(double value) const { return (open ? value > low : value >= low) && value <= high; }
};
// What is typed for the two values of a choice: of an enumeration in its order, of a bool false first.
using Words = std::array<const char*, 2>;

// Every option once, for the command line, for run.json and for what may be read back: visit(text, option), and
// visit(text, option, words) for a choice.
template <class SomeOptions, class Visit>
void each_option(SomeOptions& o, const Visit& visit) {
  visit(OptionText{"dt", nullptr, "", 1e-5, 1}, o.dt);
  visit(OptionText{"solver", "solver",
                   "NAME:key=value,...; default: cone, with --mu 0 dual_active_set (./zwang solvers)"},
        o.solver);
  visit(OptionText{"tolerance", "tolerance", "that the solver is asked for; default: 1e-10", 1e-16, 1}, o.tolerance);
  visit(OptionText{"mu", "mu", "friction of the hand on objects; 0: none; default: 0.8", 0}, o.mu);
  visit(OptionText{"law", "law", "how friction is read (docs/formulation.md)"}, o.law, Words{"coulomb", "convex"});
  visit(OptionText{"limits", "limits", "rows of joint limits before they are met, or once violated"}, o.limits,
        Words{"predictive", "violated"});
  visit(OptionText{"commit", "commit", "close the joints after each step, or the linear step alone"}, o.commit,
        Words{"cycle", "printed"});
  visit(OptionText{"toc_twice", "toc", "time of contact applied once, or as Eq. 29-30 are printed"}, o.toc_twice,
        Words{"once", "twice"});
  visit(OptionText{"toc_of_all", "toc-of", "whose time of contact ends a sub-step (all: Algorithm 1)"}, o.toc_of_all,
        Words{"cluster", "all"});
  visit(OptionText{"clusters", "clusters", "each hand solved apart"}, o.clusters, Words{"off", "on"});
  visit(OptionText{"reduce_contacts", "thinning", "contacts reduced to those that carry"}, o.reduce_contacts,
        Words{"off", "on"});
  visit(OptionText{"lazy_contacts", "lazy",
                   "what thinning took is given back where the solve needs it; off: all of it, at once"},
        o.lazy_contacts, Words{"off", "on"});
  visit(OptionText{"maximal", "model", "26 unknowns a hand, or 96 with 70 joint rows"}, o.maximal,
        Words{"reduced", "maximal"});
  visit(OptionText{"force_stiffness", "k-f",
                   "stiffness of the coupling to the engine [1/s^2]; default: 10,000, with --mu 0 1,000", 0},
        o.force_stiffness);
  visit(OptionText{"force_cap", "cap", "largest push on one object [N]; default: 60", 0}, o.force_cap);
  visit(OptionText{"gap", "gap", "that contact rows keep [m]; default: 2e-4", 0, unbounded, true}, o.gap);
  visit(OptionText{"activation", "activation", "distance from which contacts are rows [m]; default: 2e-3", 0, unbounded,
                   true},
        o.activation);
  visit(OptionText{"sub_steps", "sub-steps", "of a frame, at most; default: 3", 1, 100}, o.sub_steps);
  visit(OptionText{"verify", "verify",
                   "the referee looks at the solves of every N-th frame (default 10; 0: of none); it takes its time,\n"
                   "which is not in the figures",
                   0},
        o.verify);
}

}  // namespace zwang::god
