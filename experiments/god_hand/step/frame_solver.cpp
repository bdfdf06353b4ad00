#include <zwang/experiments/god_hand/step/frame_solver.h>

#include <Eigen/QR>
#include <algorithm>

#include <zwang/core/problem/deadline.h>
#include <zwang/core/problem/law.h>
#include <zwang/solvers/active_set/dual_active_set.h>
#include <zwang/solvers/friction/cone.h>
#include <zwang/solvers/registry.h>

namespace zwang::god {
namespace {

// With `maximal` its setting "reduce", where it has one, is off.
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

// The solver that the options name, unless there is friction and the exact one is faster at it.
AnySolver plain_solver_of(Options options) {
  if (options.mu > 0) options.solver = DualActiveSet::name;
  return solver_of(options);
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
  const Vector lambda = J_t.completeOrthogonalDecomposition().solve(pull);
  solution.lambda.setZero(problem.rows());
  for (std::size_t k = 0; k < touched.size(); ++k) {
    const double l = lambda[static_cast<Index>(k)];
    solution.lambda[touched[k]] = problem.is_equality(touched[k]) ? l : std::max(l, 0.0);
  }
}

// Does a motion over dt leave no row by more than joints and limits may be off?
bool keeps_rows(const Problem& problem, const Vector& z, double dt) {
  const Vector off = (problem.J * z - problem.c) * dt * dt;
  for (Index i = 0; i < problem.rows(); ++i)
    if (!problem.is_tangent(i) &&
        !(problem.is_equality(i) ? std::abs(off[i]) <= closed_within : off[i] >= -closed_within))
      return false;
  return true;
}

bool gave_up(Status s) {
  return s == Status::iteration_limit || s == Status::time_limit || s == Status::numerical_failure;
}

Law simpler(Law law) { return lifts(law) ? without_lift(law) : no_friction; }

}  // namespace

FrameSolver::FrameSolver(const Options& options)
    : options_(options),
      solver_(solver_of(options)),
      plain_(plain_solver_of(options)),
      convex_(make_solver(Cone::name)) {
  asked_.tolerance = options.tolerance;
  asked_.read_accuracy(options.accuracy);
  asked_.speed_accuracy /= options.dt;  // z is an acceleration
}

void FrameSolver::forget() { *this = FrameSolver(options_); }

AnySolver& FrameSolver::method_for(const Problem& problem) {
  return !problem.has_tangents() ? plain_ : limited() ? convex_ : solver_;
}

bool FrameSolver::solve(Problem& problem, double seconds, Solution& solution) {
  const Deadline deadline(seconds);
  if (law_) problem = under(*law_, problem);
  claimed_ = Status::unsolved;
  for (solution.status = Status::time_limit; !deadline.passed(); solution.status = Status::time_limit) {
    SolveOptions asked = asked_;
    asked.time_limit = deadline.left() / 2;
    asked.warm_start = &warm_;
    AnySolver& method = method_for(problem);
    if (problem.has_tangents() && method.name() == Cone::name) asked.max_iterations = options_.iterations;
    method.solve(problem, asked, solution);
    if (claimed_ == Status::unsolved) claimed_ = solution.status;
    if (!gave_up(solution.status) || !problem.has_tangents()) break;
    law_ = simpler(problem.law);
    problem = under(*law_, problem);
  }
  if (claimed_ == Status::unsolved) claimed_ = Status::time_limit;
  if (solution.status == Status::time_limit) law_ = no_friction;
  if (!is_answer(problem, solution)) return false;
  complete_multipliers(problem, solution);
  warm_.key = problem.key;
  warm_.lambda = solution.lambda;
  return true;
}

bool FrameSolver::is_answer(const Problem& problem, const Solution& solution) const {
  const Status s = solution.status;
  if (s != Status::solved && s != Status::solved_ill_conditioned && s != Status::iteration_limit) return false;
  return solution.z.size() == problem.size() && solution.z.allFinite() &&
         (!limited() || keeps_rows(problem, solution.z, options_.dt));
}

double left_of(const Options& options, double seconds) {
  return options.budget > 0 ? options.budget / 1e3 - seconds : std::numeric_limits<double>::infinity();
}

void first_rows(const Problem& problem, std::size_t contacts, std::vector<Index>& rows) {
  rows.resize(contacts);
  Index at = problem.rows();
  for (std::size_t k = contacts; k-- > 0; rows[k] = at) do
      --at;
    while (problem.is_tangent(at));
}

Status worse(Status a, Status b) {
  const auto rank = [](Status s) {
    return s == Status::solved ? 0 : s == Status::unsolved ? 1 : 1 + static_cast<int>(s);
  };
  return rank(a) < rank(b) ? b : a;
}

}  // namespace zwang::god
