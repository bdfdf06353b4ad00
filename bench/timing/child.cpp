#include <zwang/bench/timing/child.h>

#include <unistd.h>

#include <zwang/core/problem/cpu_clock.h>

namespace zwang {
namespace {

// The first byte of a message says what it is.
constexpr char problem_follows = 'p', call_follows = 'c';

// What the child does.
void serve(int socket, MakeSolver make) {
  const pid_t self = getpid();
  SolveService bench(std::move(make));
  Problem problem;
  for (std::string bytes; receive_message(socket, bytes) && !bytes.empty();) {
    const std::string_view content = std::string_view(bytes).substr(1);
    if (bytes.front() == problem_follows) {
      problem = unpack<Problem>(content);
    } else {
      const std::string answer = pack(bench.run(problem, unpack<SolveRequest>(content)));
      // A solver that forks may return twice: one answers.
      if (getpid() != self || !send_message(socket, answer)) break;
    }
  }
}

}  // namespace

void Child::load(const Problem& problem) {
  problem_ = &problem;
  if (peer_.runs() && !send_message(peer_.socket(), problem_follows + pack(problem))) peer_.stop();
}

SolveReply Child::run(const SolveRequest& call, const std::atomic<bool>* interrupted) {
  if (!peer_.runs()) {
    peer_.start([this](int socket) { serve(socket, std::move(make_)); });
    if (problem_) load(*problem_);
  }
  const auto give_up = [&](Status status, const std::string& message, double seconds) {
    peer_.stop();
    return SolveReply{.solution = {.status = status, .message = message}, .seconds = seconds};
  };
  clockid_t cpu;
  if (!peer_.runs() || clock_getcpuclockid(peer_.pid(), &cpu) != 0)
    return give_up(Status::crashed, "the solver's process died", 0);
  const double cpu_start = seconds_of(cpu), wall_start = seconds_of(CLOCK_MONOTONIC);
  const double deadline = (call.solves + call.warm_up) * (1.25 * call.time_limit + 0.2);

  if (!send_message(peer_.socket(), call_follows + pack(call)))
    return give_up(Status::crashed, "the solver's process died", 0);

  double used = 0;
  bool stopped = false;
  const bool answered = wait_for_message(peer_.socket(), deadline, [&](double wall) {
    used = seconds_of(cpu) - cpu_start;
    stopped = interrupted && *interrupted;
    return stopped || used > deadline || wall > 5 * deadline;
  });
  if (stopped) return give_up(Status::unsolved, "interrupted", 0);
  if (!answered) return give_up(Status::time_limit, "stopped from outside at its deadline", used);
  std::string bytes;
  if (!receive_message(peer_.socket(), bytes))
    return give_up(Status::crashed, "the solver's process died", seconds_of(CLOCK_MONOTONIC) - wall_start);
  return unpack<SolveReply>(bytes);
}

}  // namespace zwang
