#pragma once

#include <zwang/solvers/first_order/dual_iteration.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Accelerated projected gradient descent on the dual of the whitened problem,
//
//   minimize f(lambda) = 1/2 |G' lambda|^2 - h' lambda   over lambda_I >= 0
//
// (Nesterov 1983; Mazhar, Heyn, Negrut & Tasora 2015 for contacts), restarted whenever the momentum points uphill
// (O'Donoghue & Candes 2015, gradient scheme). 1/step starts from a few power iterations on G G' and doubles where the
// quadratic upper bound fails, which for this f is just |G'd|^2 > |d|^2 / step.
// One iteration is one accepted step d. Success is claimed when the natural residual is <= T and so is the distance
// still to go: a mode of eigenvalue mu leaves |y - y*| = curvature |d| / sqrt(mu), and the longest run between two
// restarts tells mu, since momentum swings with a period of order sqrt(curvature / mu).
struct Apgd {
  static constexpr auto name = "apgd";

  int max_steps = 10000;
  int power_iterations = 10;
  bool restart = true;

  static std::vector<Setting<Apgd>> settings() {
    return {{"max_steps", &Apgd::max_steps, "gradient steps before giving up"},
            {"power_iterations", &Apgd::power_iterations, "to estimate the largest eigenvalue of the Delassus matrix"},
            {"restart", &Apgd::restart, "drop the momentum when it points uphill"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  DualIteration iteration = {};
  Vector ahead = {}, y_ahead = {};  // the extrapolated point and G' of it
  Vector next = {}, y_next = {};    // the candidate
  Vector gradient = {};
};

static_assert(Solver<Apgd>);

}  // namespace zwang
