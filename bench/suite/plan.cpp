#include <zwang/bench/suite/plan.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/bench/results/measured_files.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/core/files/embedded.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/problem/wording.h>
#include <zwang/solvers/registry.h>

ZWANG_EMBEDDED(suites_json, ZWANG_SUITES)

namespace zwang {
namespace {

std::vector<std::filesystem::path> files_of(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return {path};
  std::vector<std::filesystem::path> files, tables;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    const std::filesystem::path kind = entry.path().extension();
    if (kind == ".h5" || kind == ".hdf5") files.push_back(entry.path());
    if (kind == ".dat") tables.push_back(entry.path());
  }
  // Siconos' own; beside HDF5 files a .dat may be anything.
  if (files.empty())
    files = std::move(tables);
  else if (!tables.empty())
    std::fprintf(stderr, "%s: %zu .dat files beside HDF5 files are left out; name them to have them read\n",
                 path.c_str(), tables.size());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw BadFile(path.string() + ": no *.h5, *.hdf5 or *.dat file in this folder");
  return files;
}

// "": all. Throws std::invalid_argument where a family has no problem here.
void keep_families(const std::string& families, std::vector<Instance>& instances, std::size_t& given) {
  const std::vector<std::string> present = names_of(instances, &Instance::family);
  const std::vector<std::string> kept = split(families);
  for (const std::string& family : kept)
    if (std::ranges::find(present, family) == present.end())
      throw std::invalid_argument("no problem of family '" + family + "'" + did_you_mean(family, present));
  if (kept.empty()) return;
  const auto is_kept = [&](const Instance& i) { return std::ranges::find(kept, i.family) != kept.end(); };
  given = static_cast<std::size_t>(std::ranges::count_if(std::span(instances).first(given), is_kept));
  std::erase_if(instances, [&](const Instance& i) { return !is_kept(i); });
}

// Under several laws a problem and its family get the word of each law that is not their own.
void state_under(const std::vector<Law>& laws, Plan& plan) {
  if (laws.empty()) return;
  std::vector<Instance> stated;
  for (const Instance& own : plan.instances)
    for (const Law law : laws) {
      if (!own.problem.has_tangents() && law != laws.front()) break;
      Instance instance = under(law, own);
      if (own.problem.has_tangents() && laws.size() > 1 && law != own.problem.law)
        for (std::string* name : {&instance.problem.name, &instance.family})
          name->append(" (").append(to_string(law)).append(")");
      if (own.problem.has_tangents() && laws.size() > 1 && law != stored_law)
        plan.coulomb.emplace(stated.size(), under(stored_law, own));
      stated.push_back(std::move(instance));
    }
  plan.instances = std::move(stated);
}

// Tables and pictures go by names: a second problem of one name is "name (2)".
void tell_apart(std::vector<Instance>& instances) {
  std::map<std::string, int> seen;
  for (Instance& i : instances) {
    const std::string own = i.problem.name;
    while (const int before = seen[i.problem.name]++) i.problem.name = own + " (" + std::to_string(before + 1) + ")";
  }
}

}  // namespace

std::span<const Suite> suites() {
  static const std::vector<Suite> all = [] {
    std::vector<Suite> read;
    using Texts = std::vector<std::string>;
    for (const nlohmann::json& j : nlohmann::json::parse(suites_json())) {
      Suite& suite = read.emplace_back(Suite{.name = j.at("name"),
                                             .scenes = joined(j.at("scenes").get<Texts>(), ","),
                                             .tolerances = j.at("tolerances"),
                                             .limit_s = j.at("limit_s"),
                                             .time_limit = j.at("time_limit"),
                                             .fills_time = j.value("fills_time", true),
                                             .solvers = joined(j.value("solvers", Texts()), ","),
                                             .accuracy = j.value("accuracy", false),
                                             .speed = j.value("speed", false),
                                             .conformance = j.value("conformance", false)});
      for (const std::string& law : j.value("laws", Texts())) suite.laws.push_back(parse_law(law));
    }
    return read;
  }();
  return all;
}

const Suite& find_suite(const std::string& name) {
  if (const auto found = std::ranges::find(suites(), name, &Suite::name); found != suites().end()) return *found;
  std::vector<std::string> names = names_of(suites(), &Suite::name);
  names.emplace_back("collision");  // a suite without solvers, run by bench_collision
  throw std::invalid_argument("no suite '" + name + "'" + did_you_mean(name, names) + " (" + joined(names) + ")");
}

std::vector<std::string> split_solvers(const std::string& text) {
  std::vector<std::string> all;
  for (const std::string& part : split(text)) {
    const bool setting = part.find('=') != std::string::npos && part.find(':') == std::string::npos;
    if (setting && !all.empty())
      all.back() += "," + part;
    else
      all.push_back(part);
  }
  std::vector<std::string> once;
  for (std::string& solver : all)
    if (std::ranges::find(once, solver) == once.end()) once.push_back(std::move(solver));
  return once;
}

std::vector<Law> parse_laws(const std::string& text) {
  std::vector<Law> laws;
  for (const std::string& word : split(text)) {
    const Law law = parse_law(word);
    if (std::ranges::find(laws, law) != laws.end()) throw std::invalid_argument("--law " + text + " names a law twice");
    laws.push_back(law);
  }
  if (laws.empty()) throw std::invalid_argument("--law names no law");
  return laws;
}

std::string words_of(std::span<const Law> laws, const char* separator) {
  return joined(names_of(laws, [](Law law) { return to_string(law); }), separator);
}

static std::string expected_laws(const SolverEntry& entry) {
  std::vector<Law> read;
  std::ranges::copy_if(all_laws, std::back_inserter(read),
                       [&](Law law) { return entry.laws.empty() ? !has_cones(law) : entry.reads(law); });
  return words_of(read, " or ");
}

std::string laws_not_read(const Plan& plan, std::span<const SolverEntry> among) {
  std::map<std::string, std::string> solvers;  // by what is said of them
  for (const std::string& text : split_solvers(plan.options.solvers)) {
    const SolverEntry& entry = *find_solver(text, among);
    std::map<Law, std::size_t> unread;
    for (const Instance& i : plan.instances)
      if (!entry.reads(i.problem)) ++unread[i.problem.law];
    std::string problems;
    for (const auto& [law, count] : unread)
      problems += (problems.empty() ? "" : " and ") + std::to_string(count) +
                  (count == 1 ? " problem under the law " : " problems under the law ") + std::string(to_string(law));
    if (problems.empty()) continue;
    std::string& names = solvers[" on " + problems + " (expected " + expected_laws(entry) + ")"];
    names += (names.empty() ? "" : ", ") + text;
  }
  std::string line;
  for (const auto& [said, names] : solvers) line += (line.empty() ? "Unsupported: " : "; ") + names + said;
  return line;
}

Shard read_shard(const std::string& text) {
  if (text.empty()) return {};
  const auto slash = text.find('/');  // without one, both are all of it
  const auto part = number_in<std::size_t>(text.substr(0, slash)), of = number_in<std::size_t>(text.substr(slash + 1));
  if (!part || !of || *part >= *of)
    throw std::invalid_argument("--shard " + text + " should be K/N with K from 0 to N-1, as in 0/64");
  return {*part, *of};
}

std::string why_bad(const Problem& problem) {
  if (std::string reason = bad_input(problem); !reason.empty()) return reason;
  return is_positive_definite(problem.M) ? "" : "M is not positive definite";
}

std::string Plan::title() const {
  const bool own = options.given > 0 || !options.problems.empty() || options.scenes != find_suite(options.suite).scenes;
  return own ? "your problems" : options.suite + " suite";
}

std::vector<Run> Plan::tightest_runs() const {
  std::vector<Run> tightest;
  std::ranges::copy_if(runs, std::back_inserter(tightest),
                       [&](const Run& run) { return run.tolerance == options.tolerances.back(); });
  return tightest;
}

Plan make_plan(SuiteOptions options, std::span<const SolverEntry> among) {
  const Suite& suite = find_suite(options.suite);
  Plan plan;
  plan.time_limit = options.time_limit > 0 ? options.time_limit : suite.time_limit;
  plan.second_witness = suite.name == "full";
  if (options.scenes.empty() && options.problems.empty() && options.instances.empty()) options.scenes = suite.scenes;
  plan.whole_suite =
      suite.fills_time && options.scenes == suite.scenes && options.problems.empty() && options.families.empty();
  plan.limit_s = suite.limit_s;
  const bool own_scenes = options.scenes == suite.scenes && options.problems.empty() && options.instances.empty();
  if (own_scenes && options.laws.empty()) options.laws = suite.laws;
  options.accuracy |= suite.accuracy;
  plan.shard = read_shard(options.shard);
  plan.conformance = suite.conformance && own_scenes && plan.shard.part == 0;
  if (!options.shard.empty()) {
    if (suite.speed)
      throw std::invalid_argument("the suite " + options.suite + " times sequences on one machine and has no parts");
    plan.whole_suite = false;
    plan.limit_s = 0;
  }
  if (options.tolerances.empty()) options.tolerances = suite.tolerances;
  if (options.solvers.empty())
    for (const std::string& text : split_solvers(suite.solvers))
      if (find_solver(text, among)) options.solvers += (options.solvers.empty() ? "" : ",") + text;
  if (options.solvers.empty()) options.solvers = joined(names_of(among, &SolverEntry::name), ",");

  std::sort(options.tolerances.rbegin(), options.tolerances.rend());
  options.tolerances.erase(std::unique(options.tolerances.begin(), options.tolerances.end()), options.tolerances.end());
  for (const double t : options.tolerances)
    if (!(t > 0 && t < 1)) throw std::invalid_argument("a tolerance should be between 0 and 1, as in 1e-6");
  plan.speed = suite.speed && plan.whole_suite;
  for (const std::string& text : split_solvers(options.solvers)) {
    make_solver(text, among);
    const SolverEntry& entry = *find_solver(text, among);
    Run run{.solver = text, .foreign = runs_apart(text, among)};
    // Of a yardstick a shortened limit would leave only a bound.
    if (suite.speed && entry.yardstick) run.least_time_limit = plan.time_limit;
    if (plan.speed) run.largest_island = entry.largest_island;
    for (const double t : options.tolerances) {
      run.tolerance = t;
      plan.runs.push_back(run);
    }
  }
  if (plan.runs.empty()) throw std::invalid_argument("no solver chosen");

  options.given = options.instances.size();
  plan.instances = std::move(options.instances);
  if (!options.scenes.empty())
    std::ranges::move(make_scenes(options.scenes, options.seed), std::back_inserter(plan.instances));
  if (plan.speed) {
    std::vector<Instance> measured = measured_problems();
    plan.instances.insert(plan.instances.begin(), measured.begin(), measured.end());
    std::sort(plan.instances.begin(), plan.instances.end(), [](const Instance& a, const Instance& b) {
      const Index left = a.problem.size() + a.problem.rows(), right = b.problem.size() + b.problem.rows();
      return left != right ? left < right : a.problem.name < b.problem.name;
    });
  }
  // A reader that knows the law leaves out what it does not need.
  const auto one_law = options.laws.size() == 1 ? std::optional(options.laws[0]) : std::nullopt;
  if (options.laws.size() > 1 && options.given > 0)
    throw std::invalid_argument("problems of a program's own are stated under one law at a time");
  for (std::filesystem::path& path : options.problems) {
    for (const std::filesystem::path& file : files_of(path))
      for (Instance& instance : read_problems(file, one_law)) {
        if (const std::string reason = why_bad(instance.problem); !reason.empty())
          throw BadFile(file.string() + ", problem " + instance.problem.name + ": " + reason);
        plan.instances.push_back(std::move(instance));
      }
    path = std::filesystem::absolute(path);
  }
  keep_families(options.families, plan.instances, options.given);
  state_under(options.laws, plan);
  if (plan.instances.empty()) throw std::invalid_argument("no problem chosen");
  tell_apart(plan.instances);
  plan.options = std::move(options);
  return plan;
}

}  // namespace zwang
