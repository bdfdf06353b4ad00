#include <zwang/bench/report/results.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/bench/report/tables/in_order.h>
#include <zwang/bench/report/wording.h>
#include <zwang/bench/results/seal.h>

namespace zwang::report {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// "" for null and for what is not there.
std::string text_at(const json& line, const char* key) {
  const json value = line.value(key, json());
  return value.is_null() ? "" : value.is_string() ? value.get<std::string>() : value.dump();
}

// What the report needs beside the columns.
void complete(Result& r) {
  // Coulomb's law may have several solutions, and the reference is one of them: what counts is the distance to the
  // nearest one that is proven, where the referee's verdict rests on it.
  Metrics& k = r.metrics;
  if (r.law == "coulomb" && (std::isfinite(k.z_bound) || k.verdict != Verdict::wrong)) {
    const bool rests = k.verdict == Verdict::solved || k.verdict == Verdict::near || k.verdict == Verdict::wrong;
    k.z_error = rests ? k.z_bound : unknown;
  }
  if (r.family.empty()) r.family = r.problem;
}

// A last line without its newline may be bad (a killed run), and lines whose check fails are left out. Lines of
// programs before there were checks have none.
template <class Parse>
void read_lines(const fs::path& file, std::string& torn, Parse parse) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  std::string line;
  bool checked = false;
  std::size_t damaged = 0;
  for (int row = 1; std::getline(in, line); ++row) {
    if (line.empty()) continue;
    checked |= has_seal(line);
    if (checked && !is_intact(line) && !in.eof()) {
      ++damaged;
      continue;
    }
    try {
      parse(line);
    } catch (const std::exception& error) {
      if (!in.eof()) {
        const bool json_error = dynamic_cast<const json::exception*>(&error) != nullptr;
        throw std::runtime_error(file.string() + " line " + std::to_string(row) + ": " +
                                 (json_error ? "not what zwang writes" : error.what()));
      }
      torn = "The last line of " + file.filename().string() + " is torn (the run was killed) and left out.";
    }
  }
  if (damaged > 0)
    torn = counted(damaged, "damaged line") + " of " + file.filename().string() + (damaged == 1 ? " is" : " are") +
           " left out; ./zwang bench --resume makes such runs again.";
}

// The lines of a file that may not be there, each of one of these kinds, or of a newer one.
template <class... Records>
void read_records(const fs::path& file, std::string& torn, std::vector<Records>&... all) {
  const auto append = []<class Record>(const std::string& line, std::vector<Record>& records) {
    Record record;
    if (read_json(line, record)) records.push_back(std::move(record));
  };
  if (fs::exists(file)) read_lines(file, torn, [&](const std::string& line) { (append(line, all), ...); });
}

std::size_t count_lines(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::size_t lines = 0;
  std::vector<char> part(1 << 20);
  while (in.read(part.data(), static_cast<std::streamsize>(part.size())) || in.gcount() > 0)
    lines += static_cast<std::size_t>(std::count(part.data(), part.data() + in.gcount(), '\n'));
  return lines;
}

void read_conditions(const json& about, RunFolder& run) {
  const auto add = [&](const std::string& name, const std::string& value) {
    if (!value.empty()) run.conditions.emplace_back(name, value);
  };
  const auto add_text = [&](const char* name, const char* key) { add(name, text_at(about, key)); };
  run.suite = text_at(about, "suite");
  run.title = text_at(about, "title");
  run.commit = text_at(about, "commit");
  std::vector<std::string> tolerances;
  for (const json& item : about.value("tolerances", json::array()))
    tolerances.push_back(item.is_number() ? scientific(item, 0) : item.dump());
  add_text("zwang", "zwang");
  add("commit", run.commit + (about.value("dirty", false) && !run.commit.empty() ? " with uncommitted changes" : ""));
  add("suite", run.title.empty() || run.title == run.suite + " suite" ? run.suite : "own scenes");
  add_text("command", "command");
  add_text("started", "started");
  const bool goes_on = about.contains("finished") && about["finished"].is_null();
  add("finished", goes_on ? "not finished" : text_at(about, "finished"));
  if (const auto planned = about.value("runs", std::size_t{0}); goes_on && planned > run.results.size())
    run.torn += std::string(run.torn.empty() ? "" : " ") + "Not finished: " + grouped(run.results.size()) + " of " +
                grouped(planned) + " runs so far.";
  add_text("seed", "seed");
  add("tolerances", joined(tolerances));
  for (const char* name : {"problems", "compiler", "flags"}) add_text(name, name);
  add_text("build type", "build_type");
  add_text("CPU", "cpu");
  add_text("cores", "cores");
  const json libraries = about.value("libraries", json::object());
  for (const auto& [name, version] : libraries.items()) add(name, text_at(libraries, name.c_str()));
  if (about.value("answers", false)) run.judged_by = text_at(about, "command");
  for (const json& note : about.value("notes", json::array())) run.notes.push_back(note.get<std::string>());
  for (const json& line : about.value("solvers", json::array())) {
    run.solvers.push_back({.name = text_at(line, "name"),
                           .method = text_at(line, "method"),
                           .limits = text_at(line, "limits"),
                           .foreign = line.value("foreign", false),
                           .exact = line.value("exact", false)});
  }
}

// Times of several kinds of machine do not compare: those of the one with most runs stay, the others' become unknown.
void keep_times_of_one_machine(RunFolder& run) {
  InOrder<std::string, std::size_t> runs;
  for (const Result& r : run.results) ++runs[r.machine];
  if (runs.items.size() < 2) return;
  const auto& [machine, most] = *std::ranges::max_element(runs.items, {}, [](const auto& item) { return item.second; });
  for (Result& r : run.results)
    if (r.machine != machine) r.setup_s = r.solve_s = r.solve_s_q1 = r.solve_s_q3 = r.prepare_s = r.kernel_s = unknown;
  run.notes.push_back("Times are those of " + machine + " alone: " + std::to_string(run.results.size() - most) +
                      " runs were made on other machines, and their times do not compare.");
}

// An answer counts for the solver that gave it, once: where that one was asked, too, its own run stands. A false claim
// is never left out. A trace that ends in another's answer is nobody's.
void credit_who_answered(RunFolder& run) {
  std::set<std::tuple<std::string, std::string, double, std::string>> answered;
  for (const Result& r : run.results)
    if (r.handed_to.empty()) answered.insert({r.problem, r.law, r.tolerance, r.solver});
  std::erase_if(run.results, [&](Result& r) {
    if (r.handed_to.empty()) return false;
    run.handed_over[{r.solver, r.handed_to}].insert(r.problem);
    if (r.replay.empty()) r.replay = replay_command(run.dir, r);
    r.solver = r.handed_to;
    return !answered.insert({r.problem, r.law, r.tolerance, r.solver}).second && !r.lies();
  });
  for (const auto& [names, problems] : run.handed_over)
    std::erase_if(run.traces,
                  [&](const TracePoint& p) { return p.solver == names.first && problems.contains(p.problem); });
}

std::vector<std::string> distinct(const std::vector<Result>& results, std::string Result::*field) {
  std::vector<std::string> names;
  for (const Result& r : results)
    if (std::ranges::find(names, r.*field) == names.end()) names.push_back(r.*field);
  return names;
}

}  // namespace

RunFolder read_run(const fs::path& dir, std::size_t large) {
  RunFolder run;
  run.dir = dir;
  run.label = dir.filename().empty() ? dir.parent_path().filename().string() : dir.filename().string();
  const std::size_t lines = count_lines(dir / "results.jsonl");
  run.results.reserve(lines);
  read_lines(dir / "results.jsonl", run.torn, [&](const std::string& line) {
    Result r;
    read_json(line, r);
    complete(r);
    if (r.is_recorded()) {
      run.recorded.push_back(std::move(r));
      return;
    }
    if (lines <= large) {
      r.replay = replay_command(run.dir, r);
    } else {
      // A string's room goes only with a move.
      for (std::string* text : {&r.problem_sha256, &r.cell, &r.metrics.bound_method}) *text = {};
      if (r.is_right()) {
        for (std::string* text : {&r.message, &r.worst_row}) *text = {};
        r.worst_by_type = {};
        r.conflicting = {};
      }
    }
    run.results.push_back(std::move(r));
  });
  read_records(dir / "traces.jsonl", run.torn, run.traces);
  read_records(dir / "conformance.jsonl", run.torn, run.phenomena);
  read_records(dir / "speed.jsonl", run.torn, run.assembly, run.stages, run.sequences);
  if (fs::exists(dir / "run.json")) {
    std::ifstream in(dir / "run.json");
    try {
      read_conditions(json::parse(in), run);
    } catch (const json::exception&) {
      throw std::runtime_error((dir / "run.json").string() + ": not what zwang writes");
    }
  }
  keep_times_of_one_machine(run);
  credit_who_answered(run);
  const std::vector<std::string> present = solvers_of(run.results);
  std::erase_if(run.solvers, [&](const SolverInfo& s) { return std::ranges::find(present, s.name) == present.end(); });
  for (const std::string& name : present)
    if (std::ranges::find(run.solvers, name, &SolverInfo::name) == run.solvers.end())
      run.solvers.push_back({.name = name});
  return run;
}

std::vector<RunFolder> by_class(RunFolder run) {
  const auto class_of = [](const Result& r) {
    return r.law == "coulomb" ? "Coulomb" : r.law == "convex" ? "convex cone" : "QP";
  };
  std::map<std::string, std::string> class_of_problem;
  std::set<std::string> present;
  for (const Result& r : run.results) present.insert(class_of_problem[r.problem] = class_of(r));
  if (present.empty()) return {std::move(run)};
  // Moved, not copied: a large run is in the memory once.
  auto results = std::exchange(run.results, {}), recorded = std::exchange(run.recorded, {});
  const auto traces = std::exchange(run.traces, {});
  std::map<std::string, RunFolder> parts;
  for (const std::string& name : present) parts[name] = run;
  for (Result& r : results) parts[class_of(r)].results.push_back(std::move(r));
  for (Result& r : recorded) parts[class_of(r)].recorded.push_back(std::move(r));
  for (const TracePoint& p : traces) parts[class_of_problem[p.problem]].traces.push_back(p);
  std::vector<RunFolder> classes;
  for (const char* name : {"QP", "convex cone", "Coulomb"}) {
    if (!present.contains(name)) continue;
    RunFolder& part = classes.emplace_back(std::move(parts[name]));
    if (present.size() > 1) part.problem_class = name;
    std::set<std::string> readers;
    for (const Result& r : part.results)
      if (!r.is_blank()) readers.insert(r.solver);
    std::erase_if(part.solvers, [&](const SolverInfo& s) { return !readers.contains(s.name); });
  }
  return classes;
}

std::vector<std::string> families_of(const std::vector<Result>& results) { return distinct(results, &Result::family); }
std::vector<std::string> solvers_of(const std::vector<Result>& results) { return distinct(results, &Result::solver); }

std::string replay_command(const fs::path& dir, const Result& result) {
  const fs::path file = result.problem_file.empty() ? fs::path(result.problem) : dir / result.problem_file;
  return "./zwang solve " + shell_word(file.generic_string()) + " --solver " + shell_word(result.solver) +
         " --tolerance " + scientific(result.tolerance, 0);
}

std::string replay_of(const RunFolder& run, const Result& result) {
  if (!run.judged_by.empty()) return run.judged_by;
  return result.replay.empty() ? replay_command(run.dir, result) : result.replay;
}

}  // namespace zwang::report
