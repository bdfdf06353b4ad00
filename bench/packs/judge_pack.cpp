#include <zwang/bench/packs/judge_pack.h>

#include <fstream>
#include <memory>
#include <set>

#include <zwang/bench/timing/conditions.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

// A solver whose answers are known already.
struct Contestant {
  static constexpr std::string_view name = "answers of a file";
  static constexpr auto laws = all_laws;
  std::shared_ptr<const Answers> answers = {};

  void solve(const Problem& problem, const SolveOptions&, Solution& out) const {
    const auto found = answers->of.find(problem_sha256(problem));
    if (found == answers->of.end()) {
      out.message = "no answer in " + answers->file.string();
      out.empty_z();
      return;
    }
    out = found->second.solution;
  }
};

std::string described(const Answers& a) {
  std::string text = "answers of " + a.file.filename().string();
  for (const auto& [what, said] : {std::pair("version ", &a.version), {"settings ", &a.settings}, {"on ", &a.machine}})
    if (!said->empty()) text += std::string(", ") + what + *said;
  return text;
}

}  // namespace

Outcome judge_pack(const Pack& pack, std::vector<Answers> contestants, SuiteSettings settings,
                   const std::atomic<bool>& interrupted) {
  std::vector<SolverEntry> entries;
  std::map<std::string, std::shared_ptr<const Answers>> by_name;
  std::set<double> tolerances;
  const std::vector<std::string> names = names_of(contestants);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::string& name = names[k];
    const auto answers =
        by_name.emplace(name, std::make_shared<const Answers>(std::move(contestants[k]))).first->second;
    tolerances.insert(answers->tolerance);
    entries.push_back({.name = name,
                       .method = described(*answers),
                       .laws = {Contestant::laws.begin(), Contestant::laws.end()},
                       .make = [answers](std::string_view) -> AnySolver { return Contestant{answers}; }});
  }
  Plan plan = make_plan(
      {.problems = pack.files(), .tolerances = {tolerances.begin(), tolerances.end()}, .accuracy = true}, entries);
  plan.answers = true;
  std::erase_if(plan.runs, [&](const Run& run) { return run.tolerance != by_name.at(run.solver)->tolerance; });
  settings.solvers = entries;
  settings.amend = [&](Result& r) {
    const auto contestant = by_name.find(r.solver);
    if (contestant == by_name.end()) return;  // an answer that came with its problem
    const auto& answers = contestant->second->of;
    const auto found = answers.find(r.problem_sha256);
    r.machine = contestant->second->machine;  // the report compares times of one machine alone
    r.setup_s = r.prepare_s = r.allocations = unknown;
    r.solve_s = r.solve_s_q1 = r.solve_s_q3 = found == answers.end() ? unknown : found->second.seconds;
  };
  return run_suite(plan, settings, interrupted);
}

std::size_t solve_pack(const Pack& pack, const PackRun& run, const std::filesystem::path& file,
                       const PackProgress& progress, const std::atomic<bool>& interrupted) {
  const Conditions here = conditions();
  Dispatcher dispatcher;
  const Run one{.solver = run.solver, .foreign = runs_apart(run.solver), .tolerance = run.tolerance};
  std::string name = run.solver, settings;
  if (const std::size_t colon = name.find(':'); colon != std::string::npos) {
    settings = name.substr(colon + 1);
    name.resize(colon);
  }
  std::ofstream out(file, std::ios::binary);
  out << answers_header(
      {.solver = name, .version = here.version, .settings = settings, .machine = here.cpu, .tolerance = run.tolerance});
  std::size_t done = 0;
  for (const PackedProblem& packed : pack.problems()) {
    progress(done, packed.name);
    const Instance instance = read_problems(pack.directory() / packed.file).at(0);
    const BatchLimits limits{.time_limit = run.time_limit, .budget = 0, .repeat = false};
    const std::vector<Timed> timed =
        time_batch(instance.problem, {&one, 1}, limits, dispatcher, interrupted, [](double, std::size_t) {});
    if (timed.empty()) break;
    out << answers_line(packed.sha256, {.solution = timed[0].solution, .seconds = timed[0].first_s}) << std::flush;
    if (!out) throw BadFile(file.string() + ": cannot be written");
    ++done;
  }
  return done;
}

}  // namespace zwang
