#include <zwang/solvers/friction/cone.h>

#include <cstdio>

#include <zwang/solvers/solver_entry.h>

namespace zwang {
namespace {

using End = ConeStarts::End;

// Unknowns that are never cut apart: a body's six. In files without M (M = I then) any may stand alone; without
// friction the solver that is handed the problem looks for parts itself.
Index unit_of(const Problem& problem) {
  constexpr Index body = 6;
  if (!problem.has_tangents()) return body;
  const auto& M = problem.M;
  const bool identity = M.nonZeros() == M.cols() && M.coeffs().isOnes(0);
  return identity || problem.size() % body != 0 ? 1 : body;
}

}  // namespace

// A part that hardly moves beside the others may be beyond doubles by itself, and well within them in the whole.
void Cone::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  const Deadline deadline(options.time_limit);
  works_.begin();
  normals_.begin();
  int parts = 0;
  const auto one = [&](const Problem& p, const SolveOptions& o, Solution& part) {
    ++parts;
    works_.own(p.size(), p.rows()).solve(*this, p, o, part);
    if (&p != &problem && p.has_tangents() && std::isinf(part.error_bound)) part.error_bound = Solution::unknown;
  };
  islands_.solve_apart(one, unit_of(problem), problem, options, solution);
  if (parts <= 1 || solution.status != Status::numerical_failure) return;
  const int iterations = solution.iterations;
  SolveOptions rest = options;
  rest.time_limit = deadline.left();
  one(problem, rest, solution);
  solution.iterations += iterations;
  solution.fallback = true;
}

void Cone::Work::solve(Cone& cone, const Problem& p, const SolveOptions& options, Solution& solution) {
  if (!p.has_tangents()) return hand_on(cone, p, options, solution);
  const Deadline deadline(options.time_limit);
  const ConeStarts::Job job{p, options, deadline, solution, starts_.best, cone.finish};
  climb(job);
  if (solution.status == Status::numerical_failure && contradicts_itself(cone.normals_.own(p.size(), p.rows()), job)) {
    solution.status = Status::infeasible;
    solution.zero_certificate(p.rows()) = of_normals_.certificate;
    solution.empty_answer();
    solution.message.clear();
  }
}

void Cone::Work::climb(const ConeStarts::Job& job) {
  const auto& [p, options, deadline, solution, best, finish] = job;
  if (!starts_.begin(job, ConeProgram::Want::any)) return;
  End end = starts_.climb(job);
  if (end == End::failed && starts_.can_couple(job)) end = starts_.couple(job) ? starts_.climb(job) : End::written;
  if ((end == End::failed || end == End::limit) && starts_.stands(job, true)) end = End::accepted;
  // Also where a limit ended it near enough; but of time, which a look would take.
  if (end == End::written || ((end == End::accepted || !deadline.passed()) && starts_.promises(job))) return;
  starts_.program().write(p, best.v, best.y, solution);
  if (options.observe) options.observe(solution.iterations, solution.z, solution.lambda);
  solution.status = end == End::accepted ? Status::solved
                    : deadline.passed()  ? Status::time_limit
                    : end == End::limit  ? Status::iteration_limit
                                         : Status::numerical_failure;
  if (options.prover && end == End::accepted) starts_.judge(job);
  if (solution.status == Status::numerical_failure) {
    const double left = best.natural / starts_.program().scale(best.v);
    const char* const reason = left <= options.tolerance ? "the natural residual is %.1e of the motion, and proves no z"
                                                         : "the natural residual stays at %.1e of the motion";
    solution.message.resize(80);  // a string of its own would be allocated anew
    solution.message.resize(at(std::snprintf(solution.message.data(), solution.message.size(), reason, left)));
  }
}

// Each law asks for s_n >= 0 of all contacts, whatever their friction: a proof against that is one against it.
bool Cone::Work::contradicts_itself(ConeStarts& normals, const ConeStarts::Job& job) {
  SolveOptions rest = job.options;
  rest.observe = nullptr;
  rest.accuracy = rest.speed_accuracy = 0;
  const ConeStarts::Job of_normals{job.problem, rest, job.deadline, of_normals_, normals.best};
  if (!normals.begin(of_normals, ConeProgram::Want::normals)) return of_normals_.status == Status::infeasible;
  return normals.from_inside(of_normals, ConeStarts::first_start) == End::written;
}

void Cone::Work::hand_on(Cone& cone, const Problem& p, const SolveOptions& options, Solution& solution) {
  if (!cone.without_friction) throw Stopped{Status::unsupported, "no solver was given for parts without friction"};
  if (!quadratic_) quadratic_ = cone.without_friction;
  AnySolver& solver = p.size() <= tolerances::few_unknowns ? quadratic_->few : quadratic_->many;
  solver.solve(p, options, solution);
  if (solution.handed_to.empty()) solution.handed_to = solver.name();
}

template SolverEntry entry<Cone>(SolverEntry, Cone);

}  // namespace zwang
