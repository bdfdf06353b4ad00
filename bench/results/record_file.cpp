#include <zwang/bench/results/record_file.h>

#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include <zwang/bench/timing/conditions.h>

namespace zwang {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

std::string fixed_conditions() {
  const Conditions c = conditions();
  return Json{{"commit", c.commit},         {"dirty", c.dirty}, {"compiler", c.compiler},  {"flags", c.flags},
              {"build_type", c.build_type}, {"cpu", c.cpu},     {"libraries", c.libraries}}
      .dump();
}

std::string load_record(const fs::path& directory, const std::string& kind) {
  const fs::path file = directory / "run.json";
  std::ifstream in(file);
  if (!in) throw BadFile(directory.string() + " holds no " + kind + ": run.json is missing");
  const Json record = Json::parse(in, nullptr, false);
  if (!record.is_object()) throw BadFile(file.string() + ": not a JSON object");
  return record.dump(2);
}

void replace_record(const fs::path& directory, const std::string& record) {
  replace_file(directory / "run.json", record + "\n");
}

void require_same_conditions(const fs::path& directory, const std::string& record, const std::string& therefore,
                             bool any_cpu) {
  const Json here = Json::parse(fixed_conditions()), stored = Json::parse(record);
  for (const auto& [name, value] : here.items())
    if (const Json was = stored.value(name, Json()); was != value && !(any_cpu && name == "cpu"))
      throw BadFile(directory.string() + " cannot go on, " + therefore + ": its " + name + " is " + was.dump() +
                    ", now it is " + value.dump());
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

}  // namespace zwang
