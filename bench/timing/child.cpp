#include <zwang/bench/timing/child.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <ctime>
#include <stdexcept>
#include <system_error>

#include <zwang/bench/timing/wire.h>

namespace zwang {
namespace {

enum class Message : char { problem, call };

bool write_all(int socket, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t sent = send(socket, data, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    data += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool read_all(int socket, char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t got = recv(socket, data, size, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    data += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

// A message is its length, then its bytes.
bool send_message(int socket, const Outgoing& out) {
  const std::size_t size = out.bytes().size();
  return write_all(socket, reinterpret_cast<const char*>(&size), sizeof size) &&
         write_all(socket, out.bytes().data(), size);
}

bool receive_message(int socket, std::vector<char>& bytes) {
  std::size_t size = 0;
  if (!read_all(socket, reinterpret_cast<char*>(&size), sizeof size)) return false;
  bytes.resize(size);
  return read_all(socket, bytes.data(), size);
}

// The child's whole life.
[[noreturn]] void serve(int socket, MakeSolver make, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(0);
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_DFL);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const int null = open("/dev/null", O_RDWR);
  if (null >= 0)
    for (const int fd : {0, 1, 2}) dup2(null, fd);

  SolveService bench(std::move(make));
  Problem problem;
  std::vector<char> bytes;
  while (receive_message(socket, bytes)) {
    Incoming in(std::move(bytes));
    if (in.get<Message>() == Message::problem) {
      problem = get_problem(in);
      continue;
    }
    Outgoing reply;
    put(reply, bench.run(problem, get_call(in)));
    if (!send_message(socket, reply)) break;
    bytes = {};
  }
  _exit(0);
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
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0) throw std::system_error(errno, std::generic_category(), "no child process");
  if (pid_ == 0) {
    close(ends[0]);
    serve(ends[1], std::move(make_), parent);
  }
  close(ends[1]);
  socket_ = ends[0];
  if (problem_) load(*problem_);
}

void Child::stop() {
  if (pid_ < 0) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  close(socket_);
  pid_ = socket_ = -1;
}

void Child::load(const Problem& problem) {
  problem_ = &problem;
  if (pid_ < 0) return;
  Outgoing out;
  out.put(Message::problem);
  put(out, problem);
  if (!send_message(socket_, out)) stop();
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

  Outgoing out;
  out.put(Message::call);
  put(out, call);
  if (!send_message(socket_, out)) return give_up(Status::crashed, "the solver's process died", 0);

  // Wait for the first bytes of the reply; look at the clocks 100 times within the deadline.
  for (pollfd waiting{socket_, POLLIN, 0};;) {
    const int milliseconds = static_cast<int>(std::clamp(deadline * 10, 1.0, 100.0));
    if (poll(&waiting, 1, milliseconds) > 0) break;
    if (interrupted && *interrupted) return give_up(Status::unsolved, "interrupted", 0);
    const double used = seconds_of(cpu) - cpu_start, wall = seconds_of(CLOCK_MONOTONIC) - wall_start;
    if (used > deadline || wall > 5 * deadline)
      return give_up(Status::time_limit, "stopped from outside at its deadline", used);
  }
  std::vector<char> bytes;
  if (!receive_message(socket_, bytes))
    return give_up(Status::crashed, "the solver's process died", seconds_of(CLOCK_MONOTONIC) - wall_start);
  Incoming in(std::move(bytes));
  return get_answer(in);
}

}  // namespace zwang
