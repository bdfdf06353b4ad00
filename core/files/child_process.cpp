#include <zwang/core/files/child_process.h>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <system_error>

namespace zwang {

int start_child(const std::function<void()>& life) {
  const pid_t parent = getpid(), child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "no child process");
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

int wait_for_child(int child) {
  int status = -1;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace zwang
