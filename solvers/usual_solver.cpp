#include <zwang/solvers/usual_solver.h>

#include <algorithm>

#include <zwang/core/problem/islands.h>

namespace zwang {

std::string_view usual_solver(const Problem& problem) {
  if (problem.has_tangents()) return "cone";
  constexpr Index many = 1000;
  const auto inequalities = [](const Problem& p) { return std::ranges::count(p.kind, RowKind::inequality); };
  if (inequalities(problem) <= many) return "dual_active_set";
  Islands islands;
  islands.split(problem);
  const auto large = [&](const Island& island) { return inequalities(island.problem) > many; };
  return std::ranges::any_of(islands.all(), large) ? "newton" : "dual_active_set";
}

}  // namespace zwang
