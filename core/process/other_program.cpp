#include <zwang/core/process/other_program.h>

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <limits>
#include <system_error>

#include <zwang/core/problem/solver.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

constexpr int socket_of_program = 3;

std::string variable_of(std::string_view name) {
  std::string variable(name);
  std::ranges::transform(variable, variable.begin(),
                         [](unsigned char c) { return static_cast<char>(c == '-' ? '_' : std::toupper(c)); });
  return variable;
}

// The program, or the Python module.
std::filesystem::path file_of_this_code() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<void*>(&find_program), &info) == 0 || !info.dli_fname) return {};
  std::error_code none;
  const std::filesystem::path file = std::filesystem::weakly_canonical(info.dli_fname, none);
  return std::filesystem::exists(file, none) ? file : std::filesystem::read_symlink("/proc/self/exe", none);
}

}  // namespace

std::filesystem::path find_program(std::string_view name) {
  const auto runs = [](const std::filesystem::path& file) { return access(file.c_str(), X_OK) == 0; };
  if (const char* const said = std::getenv(variable_of(name).c_str())) return runs(said) ? said : "";
  for (std::filesystem::path folder = file_of_this_code().parent_path();; folder = folder.parent_path()) {
    if (runs(folder / name)) return folder / name;
    if (runs(folder / "bin" / name)) return folder / "bin" / name;
    if (folder == folder.parent_path()) break;
  }
  const char* const path = std::getenv("PATH");
  for (const std::string& folder : split(path ? path : "", ':'))
    if (runs(std::filesystem::path(folder) / name)) return std::filesystem::path(folder) / name;
  const std::filesystem::path installed = std::filesystem::path(ZWANG_BINDIR) / name;
  return runs(installed) ? installed : "";
}

void OtherProgram::start() {
  const std::string file = find_program(name_).string();
  if (file.empty())
    throw Stopped{Status::unsupported, "the program " + name_ + " is not there; expected in PATH, or as " +
                                           variable_of(name_) + " in the environment"};
  peer_.start([&](int socket) {
    // One thread, as everywhere here; OpenBLAS reads this when it is loaded.
    for (const char* name : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"}) setenv(name, "1", 0);
    // The copy stays open in the program; nothing else is passed on.
    const int copy = dup(socket);
    if (copy < 0 || dup2(copy, socket_of_program) < 0) return;
    close_range(socket_of_program + 1, std::numeric_limits<unsigned>::max(), 0);
    execl(file.c_str(), name_.c_str(), nullptr);
  });
}

std::string OtherProgram::ask(std::string_view question, double seconds) {
  if (!peer_.runs()) start();
  std::string answer;
  bool answered = send_message(peer_.socket(), question);
  if (answered && !wait_for_message(peer_.socket(), seconds, [&](double wall) { return wall > seconds; })) {
    peer_.stop();
    throw Stopped{Status::time_limit, name_ + " was stopped at its deadline"};
  }
  answered = answered && receive_message(peer_.socket(), answer);
  if (!answered) {
    peer_.stop();
    throw Stopped{Status::crashed, name_ + " died"};
  }
  return answer;
}

int OtherProgram::serve(const std::function<std::string(std::string_view question)>& answer) {
  for (std::string question; receive_message(socket_of_program, question);)
    if (!send_message(socket_of_program, answer(question))) return EXIT_FAILURE;
  return EXIT_SUCCESS;
}

}  // namespace zwang
