#include <zwang/core/files/isolated.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <new>
#include <system_error>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ZWANG_ADDRESS_SANITIZER  // it reserves terabytes of addresses
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define ZWANG_ADDRESS_SANITIZER
#endif

namespace zwang {
namespace {

enum Ending : int { returned = 0, refused = 10, out_of_memory = 11, not_written = 12 };  // the child's exit codes

// A file descriptor, closed at the end.
struct Descriptor {
  int number;
  Descriptor(int opened, const char* what) : number(opened) {
    if (number < 0) throw std::system_error(errno, std::generic_category(), what);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(number); }
};

void limit(int resource, rlim_t soft, rlim_t hard) {
  const rlimit both{soft, hard};
  setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

[[maybe_unused]] std::size_t bytes_held() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

bool write_all(int file, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = write(file, text.data() + done, text.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    done += static_cast<std::size_t>(written);
  }
  return true;
}

std::string read_all(int file) {
  std::string text(static_cast<std::size_t>(lseek(file, 0, SEEK_END)), '\0');
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t got = pread(file, text.data() + done, text.size() - done, static_cast<off_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw std::system_error(errno, std::generic_category(), "the answer of a child process");
    done += static_cast<std::size_t>(got);
  }
  return text;
}

// The child's whole life. Destructors and what is registered with atexit belong to the parent.
[[noreturn]] void live(int answer, pid_t parent, const std::filesystem::path& file, const IsolationLimits& limits,
                       const std::function<std::string()>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(refused);
  std::signal(SIGINT, SIG_IGN);  // the parent decides
  for (const int signal : {SIGTERM, SIGXCPU, SIGABRT}) std::signal(signal, SIG_DFL);
  if (const int null = open("/dev/null", O_RDWR); null >= 0)
    for (const int stream : {0, 1, 2}) dup2(null, stream);
  const auto seconds = static_cast<rlim_t>(std::ceil(limits.seconds));
  limit(RLIMIT_CORE, 0, 0);
  limit(RLIMIT_CPU, seconds, seconds + 1);
#ifndef ZWANG_ADDRESS_SANITIZER
  const std::size_t most = bytes_held() + limits.bytes;
  limit(RLIMIT_AS, most, most);
#endif
  try {
    _exit(write_all(answer, work()) ? returned : not_written);
  } catch (const std::bad_alloc&) {
    _exit(out_of_memory);
  } catch (const BadFile& bad) {
    _exit(write_all(answer, bad.what()) ? refused : not_written);
  } catch (const std::exception& bad) {
    _exit(write_all(answer, file.string() + ": " + one_line(bad.what())) ? refused : not_written);
  }
}

// Waits for the child, no longer than to the deadline. Returns its status as waitpid does; -1: it was stopped.
int wait_for(pid_t child, double seconds) {
  using Clock = std::chrono::steady_clock;
  int status = -1;
  try {
    const Descriptor watched(static_cast<int>(syscall(SYS_pidfd_open, child, 0)), "no handle of a child process");
    const auto deadline = Clock::now() + std::chrono::duration<double>(seconds);
    for (pollfd ending{watched.number, POLLIN, 0};;) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
      if (poll(&ending, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 1000))) > 0) break;
      if (left > 0) continue;
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
      return -1;
    }
  } catch (const std::system_error&) {  // none to be had: the limit on CPU time ends it
  }
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

std::string isolated(const std::filesystem::path& file, const IsolationLimits& limits,
                     const std::function<std::string()>& work) {
  const Descriptor answer(memfd_create("answer", MFD_CLOEXEC), "no memory for a child process's answer");
  const pid_t parent = getpid(), child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "no child process");
  if (child == 0) live(answer.number, parent, file, limits, work);

  const int status = wait_for(child, 10 * limits.seconds);
  const int ending = status >= 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (ending == returned) return read_all(answer.number);
  if (ending == refused) throw BadFile(read_all(answer.number));
  const bool late = status < 0 || (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL));
  char why[120];
  if (late)
    std::snprintf(why, sizeof why, "not read within %.0f s", std::ceil(limits.seconds));
  else if (ending == out_of_memory || ending == not_written)
    std::snprintf(why, sizeof why, "asks for more than %.1f GB of memory", static_cast<double>(limits.bytes) * 1e-9);
  else
    std::snprintf(why, sizeof why, "its reader crashed");
  throw BadFile(file.string() + ": " + why + "; expected an undamaged file");
}

}  // namespace zwang
