#include <zwang/experiments/god_hand/step/solver_choice.h>

#include <algorithm>

#include <zwang/core/problem/dense.h>
#include <zwang/solvers/active_set/dual_active_set.h>
#include <zwang/solvers/friction/cone.h>
#include <zwang/solvers/registry.h>

namespace zwang::god {

AnySolver solver_of(const Options& options) {
  std::string text = options.solver;
  if (options.maximal && text == DualActiveSet::name) {
    DualActiveSet plain;
    plain.reduce = false;
    return plain;
  }
  const SolverEntry* entry = find_solver(text);
  if (options.maximal && entry &&
      std::any_of(entry->settings.begin(), entry->settings.end(), [](const auto& s) { return s.name == "reduce"; }))
    text += text.find(':') == std::string::npos ? ":reduce=off" : ",reduce=off";
  return make_solver(text);
}

AnySolver plain_solver_of(const Options& options) {
  if (options.mu == 0) return solver_of(options);
  Options plain = options;
  plain.solver = DualActiveSet::name;
  return solver_of(plain);
}

SolveOptions asked_of(const Problem& problem, const Options& options, const WarmStart& warm) {
  SolveOptions asked{.tolerance = options.tolerance, .warm_start = &warm};
  if (problem.has_tangents() && options.solver.starts_with(Cone::name)) asked.max_iterations = 100;
  return asked;
}

void first_rows(const Problem& problem, std::size_t contacts, std::vector<Index>& rows) {
  rows.resize(contacts);
  Index at = problem.rows();
  for (std::size_t k = contacts; k-- > 0; rows[k] = at) do
      --at;
    while (problem.is_tangent(at));
}

bool has_answer(const Problem& problem, const Solution& solution) {
  const Status s = solution.status;
  return (s == Status::solved || s == Status::solved_ill_conditioned || s == Status::iteration_limit ||
          s == Status::time_limit || (s == Status::numerical_failure && problem.has_tangents())) &&
         solution.z.size() == problem.size() && solution.z.allFinite();
}

// M (z - z_u) = J' lambda over the rows that z touches: nothing else pulls.
void complete_multipliers(const Problem& problem, Solution& solution) {
  if (solution.lambda.size() == problem.rows()) return;
  const Vector slack = problem.J * solution.z - problem.c, pull = problem.M * (solution.z - problem.z_u);
  const double near = 1e-9 * (solution.z.cwiseAbs().maxCoeff() + problem.z_u.cwiseAbs().maxCoeff());
  std::vector<Index> touched;
  for (Index i = 0; i < problem.rows(); ++i)
    if (problem.is_equality(i) || slack[i] <= near) touched.push_back(i);
  Matrix J_t(problem.size(), static_cast<Index>(touched.size()));
  for (std::size_t k = 0; k < touched.size(); ++k)
    J_t.col(static_cast<Index>(k)) = Vector(problem.J.row(touched[k]).transpose());
  const Vector lambda = least_norm_solution(J_t, pull);
  solution.lambda.setZero(problem.rows());
  for (std::size_t k = 0; k < touched.size(); ++k) {
    const double l = lambda[static_cast<Index>(k)];
    solution.lambda[touched[k]] = problem.is_equality(touched[k]) ? l : std::max(l, 0.0);
  }
}

Status worse(Status a, Status b) {
  const auto rank = [](Status s) {
    return s == Status::solved ? 0 : s == Status::unsolved ? 1 : 1 + static_cast<int>(s);
  };
  return rank(a) < rank(b) ? b : a;
}

}  // namespace zwang::god
