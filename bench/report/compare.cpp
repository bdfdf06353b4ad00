// Two runs as one.

#include <algorithm>
#include <cmath>
#include <map>

#include <zwang/bench/report/tables/accuracy.h>
#include <zwang/bench/report/tables/cells.h>
#include <zwang/bench/report/tables/statistics.h>

namespace zwang::report {
namespace {

std::string identity(const Result& r) { return r.problem_sha256.empty() ? r.problem : r.problem_sha256; }

bool holds(const RunFolder& run, const std::string& solver) {
  return std::ranges::find(run.solvers, solver, &SolverInfo::name) != run.solvers.end();
}

void append(RunFolder& out, const RunFolder& run, const RunFolder& other, const std::string& mark,
            std::map<std::string, std::string>& name_of) {
  const auto shown = [&other, &mark](const std::string& solver) {
    return holds(other, solver) ? solver + " @" + mark : solver;
  };
  for (SolverInfo s : run.solvers) {
    s.style = s.name;
    s.name = shown(s.name);
    s.second = mark == "B";
    out.solvers.push_back(s);
  }
  std::map<std::string, std::string> renamed;
  for (Result r : run.results) {
    renamed[r.problem] = name_of.try_emplace(identity(r), r.problem).first->second;
    r.problem = renamed[r.problem];
    r.solver = shown(r.solver);
    out.results.push_back(r);
  }
  for (Result r : run.recorded) {
    if (const auto it = renamed.find(r.problem); it != renamed.end()) r.problem = it->second;
    const auto same = [&r](const Result& known) { return known.problem == r.problem && known.solver == r.solver; };
    if (std::ranges::none_of(out.recorded, same)) out.recorded.push_back(std::move(r));
  }
  for (TracePoint t : run.traces) {
    if (const auto it = renamed.find(t.problem); it != renamed.end()) t.problem = it->second;
    t.solver = shown(t.solver);
    out.traces.push_back(t);
  }
  out.conditions.emplace_back("run " + mark, run.dir.generic_string());
  for (const auto& [name, value] : run.conditions) out.conditions.emplace_back(name + " @" + mark, value);
  for (const std::string& note : run.notes)
    if (std::ranges::find(out.notes, note) == out.notes.end()) out.notes.push_back(note);
  if (!run.torn.empty()) out.torn += (out.torn.empty() ? "" : " ") + ("Run " + mark + ": ") + run.torn;
}

// Results of one solver by the identity of their problem.
std::map<std::string, std::vector<const Result*>> by_problem(const RunFolder& run, const std::string& solver) {
  std::map<std::string, std::vector<const Result*>> out;
  for (const Result& r : run.results)
    if (r.solver == solver) out[identity(r)].push_back(&r);
  return out;
}

int lies(const std::vector<const Result*>& runs) {
  return static_cast<int>(std::ranges::count_if(runs, [](const Result* r) { return r->lies(); }));
}

}  // namespace

RunFolder merged(const RunFolder& a, const RunFolder& b) {
  RunFolder out;
  std::map<std::string, std::string> name_of;  // problem contents -> the name it first had
  append(out, a, b, "A", name_of);
  append(out, b, a, "B", name_of);
  // A solver's two versions follow each other.
  std::map<std::string, std::size_t> first;
  for (const SolverInfo& s : out.solvers) first.try_emplace(s.style, first.size());
  std::ranges::sort(out.solvers, {}, [&](const SolverInfo& s) { return std::pair(first[s.style], s.second); });
  return out;
}

Table comparison_table(const RunFolder& a, const RunFolder& b) {
  constexpr double error = 1e-6;
  Table table("comparison");
  for (const SolverInfo& s : a.solvers) {
    if (!holds(b, s.name)) continue;
    const auto in_a = by_problem(a, s.name), in_b = by_problem(b, s.name);
    int both = 0, reached_a = 0, reached_b = 0, lies_a = 0, lies_b = 0;
    std::vector<double> ratios;
    for (const auto& [problem, runs] : in_a) {
      const auto other = in_b.find(problem);
      if (other == in_b.end()) continue;
      ++both;
      const double ta = time_to_error(runs, error), tb = time_to_error(other->second, error);
      reached_a += std::isfinite(ta);
      reached_b += std::isfinite(tb);
      lies_a += lies(runs);
      lies_b += lies(other->second);
      if (std::isfinite(ta) && std::isfinite(tb)) ratios.push_back(tb / ta);
    }
    const double ratio = geometric_mean(ratios);
    const char* tone = ratio > 1.1 ? "warn" : tone_of(false, ratio < 0.9);
    table.add("", "",
              {s.name, whole_cell(both), whole_cell(reached_a),
               whole_cell(reached_b, tone_of(reached_b<reached_a, reached_b> reached_a)),
               ratios.empty() ? Cell("-") : Cell(fixed(ratio, 2) + "x", ratio, tone), whole_cell(lies_a),
               whole_cell(lies_b, tone_of(lies_b > lies_a, lies_b < lies_a))});
  }
  table.explain();
  const auto alone = [&](const RunFolder& run, const RunFolder& other, const char* name) {
    std::vector<std::string> names;
    for (const SolverInfo& s : run.solvers)
      if (!holds(other, s.name)) names.push_back(s.name);
    if (!names.empty()) table.note += std::string(" Only in run ") + name + ": " + joined(names) + ".";
  };
  alone(a, b, "A");
  alone(b, a, "B");
  return table;
}

}  // namespace zwang::report
