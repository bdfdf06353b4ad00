#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/solver.h"
#include "experiments/god/frame.h"
#include "experiments/god/motion.h"
#include "experiments/god/surroundings.h"

namespace zwang::god {

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
  bool verify = true;  // the referee looks at every solve (not in the times)
};

// The loop of section 6 of the paper (Fig. 6): physics, resolution of penetrations, god objects per cluster,
// integration up to the time of contact, coupling back.
class Simulation {
 public:
  // `models`: one per hand. Hands start at `start`, moved clear of the objects along the way given there; throws
  // std::runtime_error, one line, when no clear place is found, and std::invalid_argument for a solver there is not.
  Simulation(Surroundings surroundings, std::span<const hand::Model> models, std::span<const Target> start,
             const Options& options);
  ~Simulation();
  Simulation(Simulation&&) noexcept;

  // One step toward the targets, one per hand. Valid until the next call.
  const Frame& step(std::span<const Target> targets);

  const Surroundings& surroundings() const;

  // The whole state between frames as text that restore() takes back: a run that is stopped and resumed at a checkpoint
  // gives the same bits as one that passes through it. Caches (warm starts, the engine's manifolds) are dropped at
  // both.
  std::string checkpoint();
  void restore(const std::string& checkpoint);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace zwang::god
