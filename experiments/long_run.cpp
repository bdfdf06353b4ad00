#include "experiments/long_run.h"

#include <csignal>
#include <ctime>
#include <string>

namespace zwang {

const std::atomic<bool>& stop_on_interrupt() {
  static std::atomic<bool> interrupted = false;
  static_assert(std::atomic<bool>::is_always_lock_free);
  struct sigaction action = {};
  action.sa_handler = [](int) { interrupted = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  return interrupted;
}

std::filesystem::path fresh_directory() {
  const std::time_t now = std::time(nullptr);
  char name[32];
  std::strftime(name, sizeof name, "%Y%m%d-%H%M", std::localtime(&now));
  std::filesystem::path path = std::filesystem::path("results") / name;
  for (int i = 2; std::filesystem::exists(path); ++i)
    path = std::filesystem::path("results") / (std::string(name) + "-" + std::to_string(i));
  return path;
}

}  // namespace zwang
