#include <zwang/bench/program/long_run.h>

#include <csignal>
#include <ctime>
#include <stdexcept>

#include <zwang/bench/report/wording.h>
#include <zwang/bench/results/record_file.h>

namespace zwang {

const std::atomic<bool>& stop_on_interrupt() {
  static std::atomic<bool> interrupted = false;
  static_assert(std::atomic<bool>::is_always_lock_free);
  struct sigaction action = {};
  action.sa_handler = [](int) { interrupted = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  return interrupted;
}

std::string command_line(const std::string& name, const std::vector<std::string>& words) {
  std::string line = "./zwang";
  line.append(" ").append(name);
  for (const std::string& word : words) line.append(" ").append(report::shell_word(word));
  return line;
}

std::filesystem::path new_directory(const std::string& out, const std::string& resume) {
  const std::string go_on = resume.empty() ? "" : "go on with " + resume + " " + report::shell_word(out) + ", or ";
  if (!out.empty() && holds_run(out))
    throw std::invalid_argument(out + " holds a run already: " + go_on + "choose another --out");
  if (std::filesystem::is_directory(out) && !std::filesystem::is_empty(out))
    throw std::invalid_argument(out + " holds other files: choose a new or empty --out");
  if (!out.empty()) return out;
  const std::time_t now = std::time(nullptr);
  char name[32];
  std::strftime(name, sizeof name, "%Y%m%d-%H%M", std::localtime(&now));
  std::filesystem::path path = std::filesystem::path("results") / name;
  for (int i = 2; std::filesystem::exists(path); ++i)
    path = std::filesystem::path("results") / (std::string(name) + "-" + std::to_string(i));
  return path;
}

}  // namespace zwang
