#include <zwang/core/process/isolated.h>

#include <sys/resource.h>
#include <sys/wait.h>

#include <cmath>
#include <csignal>
#include <new>

#include <zwang/core/problem/bad_file.h>
#include <zwang/core/problem/memory.h>
#include <zwang/core/problem/wording.h>
#include <zwang/core/process/child_process.h>

namespace zwang {
namespace {

enum Ending : char { returned, refused, out_of_memory };  // the first byte of the child's answer

void limit(int resource, rlim_t soft, rlim_t hard) {
  const rlimit both{soft, hard};
  setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

// What the child does.
std::string live(const std::filesystem::path& file, const IsolationLimits& limits,
                 const std::function<std::string()>& work) {
  const auto seconds = static_cast<rlim_t>(std::ceil(limits.seconds));
  limit(RLIMIT_CPU, seconds, seconds + 1);
#ifndef ZWANG_ADDRESS_SANITIZER
  const std::size_t most = static_cast<std::size_t>(address_space()) + limits.bytes;
  limit(RLIMIT_AS, most, most);
#endif
  try {
    try {
      return work().insert(0, 1, returned);
    } catch (const BadFile& bad) {
      return std::string(1, refused) + bad.what();
    } catch (const std::bad_alloc&) {
      return {out_of_memory};
    } catch (const std::exception& bad) {
      return std::string(1, refused) + file.string() + ": " + one_line(bad.what());
    }
  } catch (...) {
    return {out_of_memory};
  }
}

}  // namespace

std::string isolated(const std::filesystem::path& file, const IsolationLimits& limits,
                     const std::function<std::string()>& work) {
  Peer child;
  child.start([&](int socket) { send_message(socket, live(file, limits, work)); });
  const double deadline = 10 * limits.seconds;
  const bool in_time = wait_for_message(child.socket(), deadline, [&](double wall) { return wall > deadline; });
  std::string answer, why;
  if (in_time && receive_message(child.socket(), answer) && !answer.empty()) {
    const char ending = answer.front();
    answer.erase(0, 1);
    if (ending == returned) return answer;
    if (ending == refused) throw BadFile(answer);
    why = printed("asks for more than %.1f GB of memory", static_cast<double>(limits.bytes) * 1e-9);
  } else {
    const int status = child.stop();
    const bool late = !in_time || (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL));
    why = late ? printed("not read within %.0f s", std::ceil(limits.seconds)) : "its reader crashed";
  }
  throw BadFile(file.string() + ": " + why + "; expected an undamaged file");
}

}  // namespace zwang
