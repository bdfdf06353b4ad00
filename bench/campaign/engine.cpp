#include <zwang/bench/campaign/engine.h>

#include <sys/wait.h>
#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <zwang/core/files/stored_file.h>
#include <zwang/core/problem/did_you_mean.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

struct Answer {
  int code = 0;
  std::string text = {};
};

Answer shell(const std::string& command) {
  std::FILE* const pipe = popen((command + " 2>&1").c_str(), "re");
  if (!pipe) throw std::runtime_error("no shell to start tasks with");
  Answer answer;
  std::array<char, 512> part{};
  while (std::fgets(part.data(), part.size(), pipe)) answer.text += part.data();
  const int status = pclose(pipe);
  answer.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  while (!answer.text.empty() && answer.text.back() == '\n') answer.text.pop_back();
  return answer;
}

// 0,1,2,5 -> "0-2,5".
std::string ranges(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (std::size_t i = 0, last; i < numbers.size(); i = last + 1) {
    for (last = i; last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1;) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(numbers[i]);
    if (last > i) text += "-" + std::to_string(numbers[last]);
  }
  return text;
}

// When the process began, in clock ticks since boot; "" where there is none or it has ended.
std::string start_of(const std::string& process) {
  std::ifstream in("/proc/" + process + "/stat");
  std::string line;
  std::getline(in, line);
  const std::size_t name_end = line.rfind(')');
  if (name_end == std::string::npos) return "";
  std::istringstream fields(line.substr(name_end + 2));
  std::string field, state;
  fields >> state;
  for (int i = 4; i <= 22; ++i) fields >> field;  // proc(5): starttime is the 22nd field
  return state == "Z" || state == "X" ? "" : field;
}

}  // namespace

EngineKind engine_kind(const std::string& name) {
  if (name == "slurm") return EngineKind::slurm;
  if (name == "parallel") return EngineKind::parallel;
  if (name == "local") return EngineKind::local;
  throw std::invalid_argument("no engine '" + name + "'" + did_you_mean(name, {"slurm", "parallel", "local"}) +
                              " (slurm, parallel, local)");
}

void require_engine(EngineKind engine) {
  if (engine == EngineKind::slurm && shell("command -v sbatch").code != 0)
    throw std::runtime_error("Slurm is not installed here: there is no sbatch; or use --engine local");
  if (engine == EngineKind::parallel && shell("command -v parallel").code != 0)
    throw std::runtime_error("GNU parallel is not installed (Debian: apt install parallel); or use --engine local");
}

Handle start_tasks(EngineKind engine, const std::filesystem::path& directory, const std::vector<std::size_t>& tasks,
                   std::size_t at_once) {
  const std::string job = quoted((directory / "job.sh").string());
  require_engine(engine);
  std::string words;
  for (const std::size_t k : tasks) words.append(" ").append(std::to_string(k));
  if (engine == EngineKind::slurm) {
    const Answer answer =
        shell("sbatch --parsable --array=" + ranges(tasks) + "%" + std::to_string(at_once) + " " + job);
    if (answer.code != 0) throw std::runtime_error("sbatch: " + one_line(answer.text));
    return {.id = answer.text.substr(0, answer.text.find(';'))};
  }
  // A session of its own: Ctrl-C at a terminal does not reach it.
  const std::string log = quoted((directory / "logs" / "engine.log").string());
  const std::string most = std::to_string(at_once);
  std::string command;
  if (engine == EngineKind::parallel) {
    command = "setsid nohup parallel --joblog " + quoted((directory / "joblog.txt").string()) + " -j " + most + " " +
              job + " :::" + words + " </dev/null";
  } else {
    command = "printf '%s\\n'" + words + " | setsid nohup xargs -P " + most + " -I K sh -c " +
              quoted(job + " K || :");  // xargs would end with a task that is killed
  }
  const Answer answer = shell("{ " + command + " >>" + log + " 2>&1 & } ; echo $!");
  if (answer.code != 0) throw std::runtime_error("starting tasks: " + one_line(answer.text));
  return {.id = answer.text, .started = start_of(answer.text)};
}

bool is_active(EngineKind engine, const Handle& handle) {
  if (engine != EngineKind::slurm) return !handle.started.empty() && start_of(handle.id) == handle.started;
  const Answer answer = shell("squeue --noheader --format=%i --jobs=" + quoted(handle.id));
  if (answer.code == 0) return !answer.text.empty();
  return answer.text.find("Invalid job id") == std::string::npos;
}

std::string how_to_stop(EngineKind engine, const Handle& handle) {
  return engine == EngineKind::slurm ? "scancel " + handle.id : "kill -- -" + handle.id;
}

}  // namespace zwang
