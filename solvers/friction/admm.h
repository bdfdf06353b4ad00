#pragma once

#include <string_view>

#include <zwang/solvers/friction/cone_iteration.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Alternating directions on v and w = G v - h in the cones (Boyd et al. 2011, Found. Trends Mach. Learn. 3), Coulomb's
// shift refreshed at each step (Acary & Bonnefon 2022 do the same in Siconos). One factorization of M + p G'G for as
// long as the penalty p stays; it moves when the two residuals are apart. One iteration is one solve with it.
struct Admm {
  static constexpr std::string_view name = "admm";
  static constexpr auto laws = laws_that<has_cones>;
  static constexpr bool needs_friction = true;

  double penalty = 1;
  int max_steps = 20000;

  static std::vector<Setting<Admm>> settings() {
    return {{"penalty", &Admm::penalty, "weight of G v - h = w against M at the start, on unit rows"},
            {"max_steps", &Admm::max_steps, "steps before giving up"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  ConeIteration iteration = {};
  Vector w = {}, sum = {}, ray_weight = {};
  std::vector<double> D = {};
};
static_assert(Solver<Admm>);

}  // namespace zwang
