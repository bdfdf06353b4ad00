#include <zwang/bench/timing/child.h>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <algorithm>
#include <csignal>
#include <ctime>
#include <system_error>

#include <zwang/bench/timing/wire.h>
#include <zwang/core/files/child_process.h>

namespace zwang {
namespace {

enum class Message { problem, call, reply };

bool send_bytes(int socket, const void* data, std::size_t size) {
  const char* const from = static_cast<const char*>(data);
  return transfer(size, [&](std::size_t done) { return send(socket, from + done, size - done, MSG_NOSIGNAL); });
}
bool receive_bytes(int socket, void* data, std::size_t size) {
  char* const to = static_cast<char*>(data);
  return transfer(size, [&](std::size_t done) { return recv(socket, to + done, size - done, 0); });
}

// A message is its header, then its bytes.
struct Header {
  Message kind;
  std::size_t size = 0;
};
bool send_message(int socket, Message kind, const std::string& bytes) {
  const Header header{kind, bytes.size()};
  return send_bytes(socket, &header, sizeof header) && send_bytes(socket, bytes.data(), bytes.size());
}
bool receive_message(int socket, Message& kind, std::string& bytes) {
  Header header{};
  if (!receive_bytes(socket, &header, sizeof header)) return false;
  kind = header.kind;
  bytes.resize(header.size);
  return receive_bytes(socket, bytes.data(), bytes.size());
}

// What the child does.
void serve(int socket, MakeSolver make) {
  SolveService bench(std::move(make));
  Problem problem;
  std::string bytes;
  for (Message kind; receive_message(socket, kind, bytes);) {
    if (kind == Message::problem)
      problem = unpack<Problem>(bytes);
    else if (!send_message(socket, Message::reply, pack(bench.run(problem, unpack<SolveRequest>(bytes)))))
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
  if (!send_message(socket_, Message::problem, pack(problem))) stop();
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

  if (!send_message(socket_, Message::call, pack(call)))
    return give_up(Status::crashed, "the solver's process died", 0);

  // Wait for the first bytes of the reply; look at the clocks 100 times within the deadline.
  for (pollfd waiting{socket_, POLLIN, 0};;) {
    const int milliseconds = static_cast<int>(std::clamp(deadline * 10, 1.0, 100.0));
    if (poll(&waiting, 1, milliseconds) > 0) break;
    if (interrupted && *interrupted) return give_up(Status::unsolved, "interrupted", 0);
    const double used = seconds_of(cpu) - cpu_start, wall = seconds_of(CLOCK_MONOTONIC) - wall_start;
    if (used > deadline || wall > 5 * deadline)
      return give_up(Status::time_limit, "stopped from outside at its deadline", used);
  }
  std::string bytes;
  if (Message kind; !receive_message(socket_, kind, bytes))
    return give_up(Status::crashed, "the solver's process died", seconds_of(CLOCK_MONOTONIC) - wall_start);
  return unpack<SolveReply>(bytes);
}

}  // namespace zwang
