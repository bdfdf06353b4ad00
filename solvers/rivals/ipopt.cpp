#include <zwang/solvers/rivals/ipopt.h>

#include <zwang/core/problem/preparation.h>

namespace zwang {

void Ipopt::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  const double before = thread_cpu_seconds();
  IpoptRequest request{.settings = *this,
                       .tolerance = options.tolerance,
                       .time_limit = options.time_limit,
                       .max_iterations = options.max_iterations,
                       .observe = static_cast<bool>(options.observe),
                       .is_warm = options.warm_start != nullptr,
                       .problem = problem};
  if (options.warm_start) request.warm = *options.warm_start;
  // It keeps its limit by itself; this is for when it hangs.
  const double deadline = 5 * (1.25 * options.time_limit + 0.2);
  auto reply = unpack<IpoptReply>(program.open("zwang-ipopt").ask(pack(request), deadline));
  solution = std::move(reply.solution);
  seconds_elsewhere -= thread_cpu_seconds() - before;
  {
    const Preparation preparing;
    seconds_elsewhere += reply.prepare_s;
  }
  seconds_elsewhere += reply.seconds - reply.prepare_s;
  for (const Iterate& i : reply.iterates) options.observe(i.iteration, i.z, i.lambda);
}

}  // namespace zwang
