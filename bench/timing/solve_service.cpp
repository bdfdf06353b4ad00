#include <zwang/bench/timing/solve_service.h>

#include <optional>

#include <zwang/bench/timing/allocations.h>
#include <zwang/core/problem/memory.h>

namespace zwang {

bool is_rung(int iteration) {
  // 2^k and 3 * 2^k.
  while (iteration > 3 && iteration % 2 == 0) iteration /= 2;
  return iteration >= 0 && iteration <= 3;
}

AnySolver& SolveService::solver(const SolveRequest& call) {
  const auto kept = kept_.find(call.solver);
  if (kept == kept_.end()) return kept_.emplace(call.solver, make_(call.solver)).first->second;
  if (call.fresh) kept->second = make_(call.solver);
  return kept->second;
}

SolveReply SolveService::run(const Problem& problem, const SolveRequest& call) {
  SolveReply answer;
  Solution& solution = answer.solution;
  SolveOptions options{.tolerance = call.tolerance,
                       .max_iterations = call.max_iterations,
                       .time_limit = call.time_limit,
                       .warm_start = call.warm.key.empty() ? nullptr : &call.warm,
                       .form = call.form};
  options.read_accuracy(call.accuracy);
  if (call.observe)
    options.observe = [&](int iteration, const Vector& z, const Vector& lambda) {
      if (is_rung(iteration)) answer.iterates.push_back({iteration, z, lambda});
    };
  const MemoryCap cap;
  try {
    AnySolver& chosen = solver(call);
    if (const std::string reason = chosen.supports(problem); !reason.empty())
      return {.solution = {.status = Status::unsupported, .message = reason}};
    // Short solves are timed without the clock in them: the solve before them says what preparation takes.
    std::optional<Preparation::Watch> watch(std::in_place);
    if (call.warm_up) {
      chosen.solve(problem, options, solution);
      answer.prepare_s = watch->sum();
      watch.reset();
    }
    // Its storage is the caller's.
    solution.zero_certificate(problem.rows());
    solution.reset(problem.size(), problem.rows());
    solution.redundant.reserve(problem.kind.size());
    solution.message.reserve(512);
    const long blocks = allocations();
    const double start = thread_cpu_seconds();
    for (int i = 0; i < call.solves; ++i) chosen.solve(problem, options, solution);
    answer.seconds = (thread_cpu_seconds() - start) / call.solves;
    if (watch) answer.prepare_s = watch->sum() / call.solves;
    answer.allocations = static_cast<double>(allocations() - blocks) / call.solves;
  } catch (const std::exception& thrown) {
    solution = {.status = Status::numerical_failure, .message = std::string("threw: ") + thrown.what()};
  }
  return answer;
}

}  // namespace zwang
