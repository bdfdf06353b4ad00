#include <zwang/bench/results/record_file.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include <zwang/bench/timing/conditions.h>
#include <zwang/core/problem/wording.h>

namespace zwang {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

Json fixed_conditions() {
  const Conditions c = conditions();
  return {{"commit", c.commit},         {"dirty", c.dirty}, {"compiler", c.compiler},  {"flags", c.flags},
          {"build_type", c.build_type}, {"cpu", c.cpu},     {"libraries", c.libraries}};
}

Json load_record(const fs::path& directory, const std::string& kind) {
  const fs::path file = directory / "run.json";
  std::ifstream in(file);
  if (!in) throw BadFile(directory.string() + " holds no " + kind + ": run.json is missing");
  Json record = Json::parse(in, nullptr, false);
  if (!record.is_object()) throw BadFile(file.string() + ": not a JSON object");
  return record;
}

void replace_record(const fs::path& directory, const Json& record) {
  replace_file(directory / "run.json", record.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void require_same_conditions(const fs::path& directory, const Json& stored, const std::string& therefore,
                             bool any_cpu) {
  const Json here = fixed_conditions();
  for (const auto& [name, value] : here.items())
    if (const Json was = stored.value(name, Json()); was != value && !(any_cpu && name == "cpu"))
      throw BadFile(directory.string() + " cannot go on, " + therefore + ": its " + name + " is " + was.dump() +
                    ", now it is " + value.dump());
}

std::shared_ptr<void> only_writer(const fs::path& directory) {
  const int folder = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  // What a killed run has started lets go a moment later.
  for (int k = 0; flock(folder, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; usleep(50000))
    if (++k > 20) throw std::invalid_argument(directory.string() + ": another run of zwang writes into it");
  return {nullptr, [folder](void*) { close(folder); }};
}

bool holds_run(const fs::path& directory) {
  for (const char* file : {"run.json", "results.jsonl", "frames.h5", "collision.json"})
    if (fs::exists(directory / file)) return true;
  return false;
}

std::string now_iso8601() {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  return text;
}

std::string cell_name(const std::string& commit, const std::string& problem_file, const std::string& problem_sha256,
                      const std::string& solver, double tolerance) {
  const std::string digits = printed("%.17g", tolerance);
  return sha256(commit + '\n' + problem_file + '\n' + problem_sha256 + '\n' + solver + '\n' + digits).substr(0, 32);
}

std::string problem_file(std::size_t position) { return printed("problems/%04zu.h5", position); }

}  // namespace zwang
