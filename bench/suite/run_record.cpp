#include <zwang/bench/suite/run_record.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/bench/results/record_file.h>
#include <zwang/bench/results/records.h>
#include <zwang/bench/timing/conditions.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/law.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

using Json = nlohmann::ordered_json;

// The options of a run, by the names they have on the command line: each(name, member, column).
template <class Options, class Each>
void visit_options(Options& o, Each each) {
  const Columns<Each> visit{each};
  visit("suite", o.suite, "scenes", o.scenes, "families", o.families, "problems", o.problems, "law", o.laws);
  visit("solvers", o.solvers, "tolerances", o.tolerances, "repetitions", o.repetitions, "time_limit", o.time_limit);
  visit("seed", o.seed, "trace", o.trace, "sequence", o.sequence, "given", o.given, "accuracy", o.accuracy);
  visit("shard", o.shard);
}

Json to_json(const SuiteOptions& options) {
  Json j;
  visit_options(options, [&j](const std::string& name, const auto& value, const Column&) {
    if constexpr (std::is_same_v<decltype(value), const std::vector<Law>&>)
      j[name] = value.empty() ? Json() : Json(words_of(value));
    else
      j[name] = value;
  });
  return j;
}

SuiteOptions options_from(const Json& j) {
  SuiteOptions options;
  visit_options(options, [&j](const std::string& name, auto& value, const Column&) {
    if constexpr (!std::is_same_v<decltype(value), std::vector<Law>&>)
      j.at(name).get_to(value);
    else if (j.at(name).is_string())
      value = parse_laws(j.at(name).get<std::string>());
  });
  return options;
}

Json load(const std::filesystem::path& directory) {
  Json j = load_record(directory, "run");
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
  Json solvers = Json::array(), hashes = Json::array(), names = Json::array();
  for (const std::string& text : split_solvers(plan.options.solvers)) {
    const SolverEntry& e = *find_solver(text, among);
    solvers.push_back({{"name", text},
                       {"method", e.method},
                       {"limits", e.limits},
                       {"foreign", runs_apart(text, among)},
                       {"exact", e.exact}});
  }
  for (const Instance& instance : plan.instances) {
    hashes.push_back(problem_sha256(instance.problem));
    names.push_back(instance.problem.name);
  }
  Json j = {{"zwang", c.version},        {"suite", plan.options.suite},
            {"title", plan.title()},     {"command", record.command},
            {"started", record.started}, {"finished", record.finished.empty() ? Json(nullptr) : Json(record.finished)},
            {"seed", plan.options.seed}};
  j.update(fixed_conditions());
  j["debug"] = c.debug;
  j["cores"] = c.cores;
  j["tolerances"] = plan.options.tolerances;
  j["solvers"] = solvers;
  j["problems"] = plan.problems();
  j["runs"] = plan.size();
  j["options"] = to_json(plan.options);
  j["problem_sha256"] = hashes;
  j["problem_names"] = names;
  if (plan.answers) j["answers"] = true;
  j["notes"] = record.notes;
  replace_record(directory, j);
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
                               const std::function<bool(const std::string&)>& is_given) {
  const Json j = load(directory);
  const Json options = j.at("options"), asked = to_json(typed);
  if (!options.is_object()) throw BadFile((directory / "run.json").string() + ": its options are no object");
  const bool part = options.value("shard", Json("")) != "";  // each of its lines names its machine
  require_same_conditions(directory, j, "its times would not compare", part);
  for (const auto& [name, value] : asked.items())
    if (const Json stored = options.value(name, Json()); is_given(name) && stored != value)
      throw std::invalid_argument(directory.string() + " cannot go on with other options: its " + name + " is " +
                                  stored.dump() + ", not " + value.dump());
  return from_record(directory, [&] {
    SuiteOptions stored = options_from(options);
    for (std::size_t b = 0; b < stored.given; ++b)
      stored.instances.push_back(read_problems(directory / problem_file(b)).at(0));
    return stored;
  });
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
