#include <zwang/bench/timing/child.h>

#include <sys/socket.h>
#include <unistd.h>
#include <csignal>
#include <ctime>
#include <system_error>

#include <zwang/bench/timing/wire.h>
#include <zwang/core/files/child_process.h>

namespace zwang {
namespace {

// The first byte of a message says what it is.
constexpr char problem_follows = 'p', call_follows = 'c';

// What the child does.
void serve(int socket, MakeSolver make) {
  SolveService bench(std::move(make));
  Problem problem;
  for (std::string bytes; receive_message(socket, bytes) && !bytes.empty();) {
    const std::string_view content = std::string_view(bytes).substr(1);
    if (bytes.front() == problem_follows)
      problem = unpack<Problem>(content);
    else if (!send_message(socket, pack(bench.run(problem, unpack<SolveRequest>(content)))))
      break;
  }
}

double seconds_of(clockid_t clock) {
  timespec t{};
  return clock_gettime(clock, &t) == 0 ? static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec) : 0;
}

}  // namespace

void Child::start() {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::system_error(errno, std::generic_category(), "no socket for a child process");
  pid_ = start_child([&] {
    close(ends[0]);
    serve(ends[1], std::move(make_));
  });
  close(ends[1]);
  socket_ = ends[0];
  if (problem_) load(*problem_);
}

void Child::stop() {
  if (pid_ < 0) return;
  kill(pid_, SIGKILL);
  wait_for_child(pid_);
  close(socket_);
  pid_ = socket_ = -1;
}

void Child::load(const Problem& problem) {
  problem_ = &problem;
  if (pid_ < 0) return;
  if (!send_message(socket_, problem_follows + pack(problem))) stop();
}

SolveReply Child::run(const SolveRequest& call, const std::atomic<bool>* interrupted) {
  if (pid_ < 0) start();
  SolveReply answer;
  const auto give_up = [&](Status status, std::string message, double seconds) {
    stop();
    answer.solution.reset(0, 0);
    answer.solution.status = status;
    answer.solution.message = std::move(message);
    answer.seconds = seconds;
    return answer;
  };
  clockid_t cpu;
  if (pid_ < 0 || clock_getcpuclockid(pid_, &cpu) != 0) return give_up(Status::crashed, "the solver's process died", 0);
  const double cpu_start = seconds_of(cpu), wall_start = seconds_of(CLOCK_MONOTONIC);
  const double deadline = (call.solves + call.warm_up) * (1.25 * call.time_limit + 0.2);

  if (!send_message(socket_, call_follows + pack(call)))
    return give_up(Status::crashed, "the solver's process died", 0);

  double used = 0;
  bool stopped = false;
  const bool answered = wait_for_message(socket_, deadline, [&](double wall) {
    used = seconds_of(cpu) - cpu_start;
    stopped = interrupted && *interrupted;
    return stopped || used > deadline || wall > 5 * deadline;
  });
  if (stopped) return give_up(Status::unsolved, "interrupted", 0);
  if (!answered) return give_up(Status::time_limit, "stopped from outside at its deadline", used);
  std::string bytes;
  if (!receive_message(socket_, bytes))
    return give_up(Status::crashed, "the solver's process died", seconds_of(CLOCK_MONOTONIC) - wall_start);
  return unpack<SolveReply>(bytes);
}

}  // namespace zwang
