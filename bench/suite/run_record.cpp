#include <zwang/bench/suite/run_record.h>

#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include <zwang/bench/results/record_file.h>
#include <zwang/bench/timing/conditions.h>

namespace zwang {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const SuiteOptions& o) {
  Json problems = Json::array();
  for (const auto& path : o.problems) problems.push_back(path.string());
  return {{"suite", o.suite},
          {"scenes", o.scenes},
          {"families", o.families},
          {"problems", problems},
          {"friction", o.friction == Friction::pyramid ? "pyramid" : "none"},
          {"solvers", o.solvers},
          {"tolerances", o.tolerances},
          {"repetitions", o.repetitions},
          {"seed", o.seed},
          {"trace", o.trace}};
}

SuiteOptions options_from(const Json& j) {
  SuiteOptions o;
  o.suite = j.at("suite");
  o.scenes = j.at("scenes");
  o.families = j.at("families");
  for (const std::string path : j.at("problems")) o.problems.emplace_back(path);
  o.friction = j.at("friction") == "pyramid" ? Friction::pyramid : Friction::none;
  o.solvers = j.at("solvers");
  o.tolerances = j.at("tolerances").get<std::vector<double>>();
  o.repetitions = j.at("repetitions");
  o.seed = j.at("seed");
  o.trace = j.at("trace");
  return o;
}

Json load(const std::filesystem::path& directory) {
  Json j = Json::parse(load_record(directory, "run"));
  if (j.value("kind", "") == "simulation")
    throw BadFile((directory / "run.json").string() + ": the record of a simulated run, not of a suite");
  for (const char* key : {"command", "started", "finished", "notes", "options", "problem_sha256"})
    if (!j.contains(key))
      throw BadFile((directory / "run.json").string() + ": written by another version of zwang (no \"" + key + "\")");
  return j;
}

}  // namespace

void write_run_record(const std::filesystem::path& directory, const Plan& plan, std::span<const SolverEntry> among,
                      const RunRecord& record) {
  const Conditions c = conditions();
  Json solvers = Json::array(), hashes = Json::array();
  for (const std::string& text : split_solvers(plan.options.solvers)) {
    const SolverEntry& e = *find_solver(text, among);
    solvers.push_back(
        {{"name", text}, {"method", e.method}, {"limits", e.limits}, {"foreign", e.foreign}, {"exact", e.exact}});
  }
  for (const Instance& instance : plan.instances) hashes.push_back(problem_sha256(instance.problem));
  Json j = {{"zwang", c.version},
            {"suite", plan.options.suite},
            {"command", record.command},
            {"started", record.started},
            {"finished", record.finished.empty() ? Json(nullptr) : Json(record.finished)},
            {"seed", plan.options.seed}};
  j.update(Json::parse(fixed_conditions()));
  j["debug"] = c.debug;
  j["cores"] = c.cores;
  j["tolerances"] = plan.options.tolerances;
  j["solvers"] = solvers;
  j["problems"] = plan.instances.size();
  j["runs"] = plan.size();
  j["options"] = to_json(plan.options);
  j["problem_sha256"] = hashes;
  j["notes"] = record.notes;
  replace_record(directory, j.dump(2));
}

RunRecord read_run_record(const std::filesystem::path& directory) {
  const Json j = load(directory);
  return from_record(directory, [&j] {
    RunRecord record;
    record.command = j.at("command");
    record.started = j.at("started");
    if (j.at("finished").is_string()) record.finished = j.at("finished");
    record.notes = j.at("notes").get<std::vector<std::string>>();
    return record;
  });
}

SuiteOptions options_to_resume(const std::filesystem::path& directory, const SuiteOptions& typed,
                               const std::vector<std::string>& given) {
  const Json j = load(directory);
  require_same_conditions(directory, j.dump(), "its times would not compare");
  const Json options = j.at("options"), asked = to_json(typed);
  if (!options.is_object()) throw BadFile((directory / "run.json").string() + ": its options are no object");
  for (const std::string& name : given)
    if (const Json stored = options.value(name, Json()); stored != asked.at(name))
      throw std::invalid_argument(directory.string() + " cannot go on with other options: its " + name + " is " +
                                  stored.dump() + ", not " + asked.at(name).dump());
  return from_record(directory, [&options] { return options_from(options); });
}

void require_same_problems(const std::filesystem::path& directory, const Plan& plan) {
  const auto stored =
      from_record(directory, [&] { return load(directory).at("problem_sha256").get<std::vector<std::string>>(); });
  for (std::size_t i = 0; i < plan.instances.size(); ++i)
    if (i >= stored.size() || stored[i] != problem_sha256(plan.instances[i].problem))
      throw BadFile(directory.string() + " cannot go on: problem " + plan.instances[i].problem.name +
                    " is no longer what it was");
}

}  // namespace zwang
