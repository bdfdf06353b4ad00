#include <zwang/core/files/isolated.h>

#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <new>
#include <system_error>

#include <zwang/core/files/child_process.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/core/problem/wording.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ZWANG_ADDRESS_SANITIZER  // it reserves terabytes of addresses
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define ZWANG_ADDRESS_SANITIZER
#endif

namespace zwang {
namespace {

enum Ending : int { returned = 0, refused = 10, out_of_memory = 11, crashed = 12 };  // the child's exit codes

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

struct NotWritten {};

void write_all(int file, const void* data, std::size_t bytes) {
  const char* const from = static_cast<const char*>(data);
  if (!transfer(bytes, [&](std::size_t done) { return write(file, from + done, bytes - done); })) throw NotWritten{};
}

// What the child does.
void live(int answer, const std::filesystem::path& file, const IsolationLimits& limits,
          const std::function<void(const WriteAnswer&)>& work) {
  const auto seconds = static_cast<rlim_t>(std::ceil(limits.seconds));
  limit(RLIMIT_CPU, seconds, seconds + 1);
#ifndef ZWANG_ADDRESS_SANITIZER
  const std::size_t most = bytes_held() + limits.bytes;
  limit(RLIMIT_AS, most, most);
#endif
  const auto refuse = [answer](const std::string& why) {
    if (ftruncate(answer, 0) != 0 || lseek(answer, 0, SEEK_SET) != 0) _exit(crashed);
    write_all(answer, why.data(), why.size());
    _exit(refused);
  };
  try {
    try {
      return work([answer](const void* data, std::size_t bytes) { write_all(answer, data, bytes); });
    } catch (const BadFile& bad) {
      refuse(bad.what());
    } catch (const std::bad_alloc&) {
      _exit(out_of_memory);
    } catch (const std::exception& bad) {
      refuse(file.string() + ": " + one_line(bad.what()));
    }
  } catch (...) {
    _exit(out_of_memory);
  }
}

// Waits for the child, no longer than to the deadline. Returns its status as waitpid does; -1: it was stopped.
int wait_for(pid_t child, double seconds) {
  using Clock = std::chrono::steady_clock;
  try {
    const Descriptor watched(static_cast<int>(syscall(SYS_pidfd_open, child, 0)), "no handle of a child process");
    const auto deadline = Clock::now() + std::chrono::duration<double>(seconds);
    for (pollfd ending{watched.number, POLLIN, 0};;) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
      if (poll(&ending, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 1000))) > 0) break;
      if (left > 0) continue;
      kill(child, SIGKILL);
      wait_for_child(child);
      return -1;
    }
  } catch (const std::system_error&) {  // none to be had: the limit on CPU time ends it
  }
  return wait_for_child(child);
}

}  // namespace

IsolatedAnswer::IsolatedAnswer(int file) {
  const off_t size = lseek(file, 0, SEEK_END);
  if (size <= 0) return;
  const auto bytes = static_cast<std::size_t>(size);
  void* mapped = mmap(nullptr, bytes, PROT_READ, MAP_SHARED | MAP_POPULATE, file, 0);
  if (mapped == MAP_FAILED) throw std::bad_alloc();
  bytes_ = {static_cast<const char*>(mapped), bytes};
}

IsolatedAnswer::~IsolatedAnswer() {
  if (!bytes_.empty()) munmap(const_cast<char*>(bytes_.data()), bytes_.size());
}

IsolatedAnswer isolated(const std::filesystem::path& file, const IsolationLimits& limits,
                        const std::function<void(const WriteAnswer&)>& work) {
  const Descriptor answer(memfd_create("answer", MFD_CLOEXEC), "no memory for a child process's answer");
  const pid_t child = start_child([&] { live(answer.number, file, limits, work); });
  const int status = wait_for(child, 10 * limits.seconds);
  const int ending = status >= 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (ending == returned) return IsolatedAnswer(answer.number);
  if (ending == refused) throw BadFile(std::string(IsolatedAnswer(answer.number).bytes()));
  const bool late = status < 0 || (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL));
  std::string why = "its reader crashed";
  if (late) why = printed("not read within %.0f s", std::ceil(limits.seconds));
  if (ending == out_of_memory)
    why = printed("asks for more than %.1f GB of memory", static_cast<double>(limits.bytes) * 1e-9);
  throw BadFile(file.string() + ": " + why + "; expected an undamaged file");
}

}  // namespace zwang
