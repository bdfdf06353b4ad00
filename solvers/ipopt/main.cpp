// zwang-ipopt: answers the questions of Ipopt::solve().
#include <zwang/core/problem/memory.h>
#include <zwang/core/problem/preparation.h>
#include <zwang/core/process/other_program.h>
#include <zwang/solvers/ipopt/ipopt_method.h>

int main() {
  using namespace zwang;
  IpoptMethod method;
  return OtherProgram::serve([&](std::string_view question) {
    const auto request = unpack<IpoptRequest>(question);
    IpoptReply reply;
    static_cast<IpoptSettings&>(method) = request.settings;
    SolveOptions options{.tolerance = request.tolerance,
                         .max_iterations = request.max_iterations,
                         .time_limit = request.time_limit,
                         .warm_start = request.is_warm ? &request.warm : nullptr};
    if (request.observe)
      options.observe = [&](int iteration, const Vector& z, const Vector& lambda) {
        reply.iterates.push_back({iteration, z, lambda});
      };
    const MemoryCap cap;
    const Preparation::Watch watch;
    const double start = thread_cpu_seconds();
    reply.solution.reset(request.problem.size(), request.problem.rows());
    const auto give_up = [&](Status status, const std::string& reason) {
      reply.solution.reset(0, 0);
      reply.solution.status = status;
      reply.solution.message = reason;
      method = IpoptMethod();
    };
    try {
      method.solve(request.problem, options, reply.solution);
    } catch (const Stopped& stopped) {
      give_up(stopped.status, stopped.message);
    } catch (const std::bad_alloc&) {
      give_up(Status::numerical_failure, "out of memory");
    }
    reply.seconds = thread_cpu_seconds() - start;
    reply.prepare_s = watch.sum();
    return pack(reply);
  });
}
