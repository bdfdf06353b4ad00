#pragma once

#include "solvers/goldfarb_idnani.h"

namespace zwang {

extern template class GoldfarbIdnani<double>;

// Goldfarb & Idnani's dual active-set method in double precision, by orthogonal updates (goldfarb_idnani.h).
// One iteration: one row entering or leaving the active set.
struct DualActiveSet {
  static constexpr std::string_view name = "dual_active_set";

  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

 private:
  GoldfarbIdnani<double> method_;
};
static_assert(Solver<DualActiveSet>);

}  // namespace zwang
