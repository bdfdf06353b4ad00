#include <zwang/core/process/child_process.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <system_error>

namespace zwang {
namespace {

int start_child(const std::function<void()>& life) {
  const pid_t parent = getpid(), child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "no child process");
  setpgid(child, child);  // by both: whoever is first
  if (child > 0) return child;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(0);
  std::signal(SIGINT, SIG_IGN);
  for (const int signal : {SIGTERM, SIGXCPU, SIGABRT}) std::signal(signal, SIG_DFL);
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  if (const int null = open("/dev/null", O_RDWR); null >= 0)
    for (const int stream : {0, 1, 2}) dup2(null, stream);
  [&]() noexcept { life(); }();  // an exception must not reach what the parent would do with it
  _exit(0);
}

}  // namespace

void Peer::start(const std::function<void(int socket)>& life) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::system_error(errno, std::generic_category(), "no socket for a child process");
  pid_ = start_child([&] {
    close(ends[0]);
    life(ends[1]);
  });
  close(ends[1]);
  socket_ = ends[0];
}

int Peer::stop() {
  if (pid_ < 0) return 0;
  kill(-pid_, SIGKILL);
  const int status = wait_for_child(pid_);
  close(socket_);
  pid_ = socket_ = -1;
  return status;
}

bool send_message(int socket, std::string_view bytes) {
  const auto send_all = [&](const char* from, std::size_t size) {
    return transfer(size, [&](std::size_t done) { return send(socket, from + done, size - done, MSG_NOSIGNAL); });
  };
  const std::size_t size = bytes.size();
  return send_all(reinterpret_cast<const char*>(&size), sizeof size) && send_all(bytes.data(), size);
}

bool receive_message(int socket, std::string& bytes) {
  const auto receive_all = [&](char* to, std::size_t size) {
    return transfer(size, [&](std::size_t done) { return recv(socket, to + done, size - done, 0); });
  };
  std::size_t size = 0;
  if (!receive_all(reinterpret_cast<char*>(&size), sizeof size)) return false;
  bytes.resize(size);
  return receive_all(bytes.data(), size);
}

bool wait_for_message(int socket, double deadline, const std::function<bool(double wall)>& enough) {
  const auto start = std::chrono::steady_clock::now();
  const int milliseconds = static_cast<int>(std::clamp(deadline * 10, 1.0, 100.0));  // 100 looks within the deadline
  for (pollfd waiting{socket, POLLIN, 0}; poll(&waiting, 1, milliseconds) <= 0;)
    if (enough(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count())) return false;
  return true;
}

int wait_for_child(int child) {
  int status = -1;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace zwang
