#pragma once

#include <string>

namespace zwang::god {

// Targets that go faster are no hand's: tracking has jumped.
inline constexpr double fastest_hand = 8;  // m/s

// The choices of a run; the defaults are the project's, the others are the paper's or an experiment's.
struct Options {
  double dt = 1e-3;                                                        // s, a simulated step
  std::string solver = "dual_active_set";                                  // with settings: "nnls:reduce=on"
  double tolerance = 1e-10;                                                // that it is asked for, and checked to
  enum class Limits { predictive, violated } limits = Limits::predictive;  // violated: the paper's rows
  enum class Commit { cycle, printed } commit = Commit::cycle;  // printed: the linear step alone; joints open
  bool toc_twice = false;                                       // Eq. 29-30 as printed
  bool toc_of_all = false;  // the smallest TOC of all clusters for every one (Algorithm 1)
  bool clusters = true;     // each hand solved apart; false: as one problem
  bool reduce_contacts = true, lazy_contacts = true;
  bool maximal = false;                  // no reduction of the equality rows, no islands, where the solver can
  double force_stiffness = 1000;         // k_f [1/s^2]
  double force_cap = 60;                 // N, a hand's push on one object
  double gap = 2e-4, activation = 2e-3;  // m: what contact rows keep; from where they are written
  int sub_steps = 3;
  int verify = 10;  // the referee looks at the solves of every so-many-th frame (not in the times); 0: of none
};

}  // namespace zwang::god
