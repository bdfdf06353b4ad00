#include "experiments/report/results.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace zwang::report {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

double number(const json& line, const char* key) {
  const auto it = line.find(key);
  return it != line.end() && it->is_number() ? it->get<double>() : unknown;
}

long count(const json& line, const char* key) {
  const double value = number(line, key);
  return std::isfinite(value) ? static_cast<long>(value) : 0;
}

std::string text(const json& line, const char* key) {
  const auto it = line.find(key);
  if (it == line.end() || it->is_null()) return "";
  return it->is_string() ? it->get<std::string>() : it->dump();
}

bool flag(const json& line, const char* key) {
  const auto it = line.find(key);
  return it != line.end() && it->is_boolean() && it->get<bool>();
}

Result parse_result(const json& line) {
  for (const char* key : {"problem", "solver", "tolerance", "claimed", "verified"})
    if (!line.contains(key))
      throw std::runtime_error(std::string("no result of this version of zwang: it has no \"") + key + "\"");
  Result r;
  r.problem = text(line, "problem");
  r.family = text(line, "family");
  if (r.family.empty()) r.family = r.problem;
  r.knob = text(line, "knob");
  r.problem_sha256 = text(line, "problem_sha256");
  r.problem_file = text(line, "problem_file");
  r.solver = text(line, "solver");
  r.claimed = text(line, "claimed");
  r.verified = text(line, "verified");
  r.reference = text(line, "reference");
  r.bound_method = text(line, "bound_method");
  r.message = text(line, "message");
  r.worst_row = text(line, "worst_row");
  r.knob_value = number(line, "knob_value");
  r.tolerance = number(line, "tolerance");
  r.n = count(line, "n");
  r.m = count(line, "m");
  r.equalities = count(line, "equalities");
  r.z_error = number(line, "z_error");
  r.z_bound = number(line, "z_bound");
  r.primal = number(line, "primal");
  r.stationarity = number(line, "stationarity");
  r.gap = number(line, "gap");
  r.setup_s = number(line, "setup_s");
  r.solve_s = number(line, "solve_s");
  r.solve_s_q1 = number(line, "solve_s_q1");
  r.solve_s_q3 = number(line, "solve_s_q3");
  r.kernel_s = number(line, "kernel_s");
  r.allocations = number(line, "allocations");
  r.range_gap = number(line, "range_gap");
  r.iterations = count(line, "iterations");
  r.repetitions = count(line, "repetitions");
  if (const auto it = line.find("feasible"); it != line.end() && it->is_boolean()) r.feasible = it->get<bool>();
  r.fallback = flag(line, "fallback");
  for (const json& row : line.value("worst_by_type", json::array()))
    r.worst_by_type.push_back(
        {text(row, "type"), text(row, "row"), text(row, "unit"), number(row, "violation"), number(row, "relative")});
  for (const json& name : line.value("conflicting", json::array())) r.conflicting.push_back(name.get<std::string>());
  return r;
}

TracePoint parse_trace(const json& line) {
  return {.problem = text(line, "problem"),
          .family = text(line, "family"),
          .solver = text(line, "solver"),
          .iteration = count(line, "iteration"),
          .time_s = number(line, "time_s"),
          .z_error = number(line, "z_error"),
          .primal = number(line, "primal"),
          .stationarity = number(line, "stationarity"),
          .gap = number(line, "gap")};
}

SequenceTimes::Start parse_start(const json& part) {
  return {.frames = count(part, "frames"),
          .checked = count(part, "checked"),
          .right = count(part, "right"),
          .solve_s = number(part, "solve_s"),
          .iterations = number(part, "iterations"),
          .allocations = number(part, "allocations"),
          .worst_z_error = number(part, "worst_z_error")};
}

void parse_speed(const json& line, Run& run) {
  if (text(line, "kind") == "assembly")
    run.assembly.push_back({.scene = text(line, "scene"),
                            .contacts = count(line, "contacts"),
                            .n = count(line, "n"),
                            .m = count(line, "m"),
                            .allocations = count(line, "allocations"),
                            .assemble_s = number(line, "assemble_s"),
                            .islands_s = number(line, "islands_s"),
                            .kernel_s = number(line, "kernel_s")});
  if (text(line, "kind") == "stages") {
    run.stages.push_back({.scene = text(line, "scene"), .contacts = count(line, "contacts")});
    for (const char* stage : {"checks", "whiten", "joints", "rows", "climb", "refine"})
      run.stages.back().stages.emplace_back(stage, number(line, stage));
  }
  if (text(line, "kind") == "sequence")
    run.sequences.push_back({.sequence = text(line, "sequence"),
                             .solver = text(line, "solver"),
                             .cold = parse_start(line.at("cold")),
                             .warm = parse_start(line.at("warm"))});
}

// Only a last line without its newline may be bad: the suite writes whole lines.
template <class Parse>
void read_lines(const fs::path& file, std::string& torn, Parse parse) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  std::string line;
  for (int row = 1; std::getline(in, line); ++row) {
    if (line.empty()) continue;
    try {
      parse(json::parse(line));
    } catch (const std::exception& error) {
      if (!in.eof()) {
        const bool json_error = dynamic_cast<const json::exception*>(&error) != nullptr;
        throw std::runtime_error(file.string() + " line " + std::to_string(row) + ": " +
                                 (json_error ? "not what zwang writes" : error.what()));
      }
      torn = "The last line of " + file.filename().string() + " is torn (the run was killed) and left out.";
    }
  }
}

std::string joined(const json& list) {
  std::string out;
  for (const json& item : list)
    out += (out.empty() ? "" : ", ") + (item.is_number() ? scientific(item, 0) : item.dump());
  return out;
}

void read_conditions(const json& about, Run& run) {
  const auto add = [&run](const std::string& name, const std::string& value) {
    if (!value.empty()) run.conditions.emplace_back(name, value);
  };
  run.suite = text(about, "suite");
  run.commit = text(about, "commit");
  add("zwang", text(about, "version"));
  add("commit", run.commit.empty() ? "" : run.commit + (flag(about, "dirty") ? " with uncommitted changes" : ""));
  add("suite", run.suite);
  add("command", text(about, "command"));
  add("started", text(about, "started"));
  add("finished", about.contains("finished") && about["finished"].is_null() ? "not finished" : text(about, "finished"));
  add("seed", text(about, "seed"));
  add("tolerances", joined(about.value("tolerances", json::array())));
  add("problems", text(about, "problems"));
  add("compiler", text(about, "compiler"));
  add("flags", text(about, "flags"));
  add("build type", text(about, "build_type"));
  add("CPU", text(about, "cpu"));
  add("cores", text(about, "cores"));
  const json libraries = about.value("libraries", json::object());
  for (const auto& [name, version] : libraries.items())
    add(name, version.is_string() ? version.get<std::string>() : version.dump());
  for (const json& note : about.value("notes", json::array())) run.notes.push_back(note.get<std::string>());
  for (const json& s : about.value("solvers", json::array()))
    run.solvers.push_back({text(s, "name"), text(s, "method"), text(s, "limits"), flag(s, "foreign")});
}

std::vector<std::string> distinct(const std::vector<Result>& results, std::string Result::* field) {
  std::vector<std::string> names;
  for (const Result& r : results)
    if (std::find(names.begin(), names.end(), r.*field) == names.end()) names.push_back(r.*field);
  return names;
}

}  // namespace

Run read_run(const fs::path& dir) {
  Run run;
  run.dir = dir;
  run.label = dir.filename().empty() ? dir.parent_path().filename().string() : dir.filename().string();
  read_lines(dir / "results.jsonl", run.torn, [&run](const json& line) {
    run.results.push_back(parse_result(line));
    run.results.back().replay = replay_command(run.dir, run.results.back());
  });
  if (fs::exists(dir / "traces.jsonl"))
    read_lines(dir / "traces.jsonl", run.torn, [&run](const json& line) { run.traces.push_back(parse_trace(line)); });
  if (fs::exists(dir / "speed.jsonl"))
    read_lines(dir / "speed.jsonl", run.torn, [&run](const json& line) { parse_speed(line, run); });
  if (fs::exists(dir / "run.json")) {
    std::ifstream in(dir / "run.json");
    try {
      read_conditions(json::parse(in), run);
    } catch (const json::exception&) {
      throw std::runtime_error((dir / "run.json").string() + ": not what zwang writes");
    }
  }
  for (const std::string& name : solvers_of(run.results))
    if (std::none_of(run.solvers.begin(), run.solvers.end(), [&name](const SolverInfo& s) { return s.name == name; }))
      run.solvers.push_back({.name = name});
  std::erase_if(run.solvers, [&run](const SolverInfo& s) {
    return std::none_of(run.results.begin(), run.results.end(), [&s](const Result& r) { return r.solver == s.name; });
  });
  return run;
}

std::vector<std::string> families_of(const std::vector<Result>& results) { return distinct(results, &Result::family); }
std::vector<std::string> solvers_of(const std::vector<Result>& results) { return distinct(results, &Result::solver); }

std::string replay_command(const fs::path& dir, const Result& result) {
  const fs::path file = result.problem_file.empty() ? fs::path(result.problem) : dir / result.problem_file;
  return "./zwang solve " + shell_word(file.generic_string()) + " --solver " + shell_word(result.solver) +
         " --tolerance " + scientific(result.tolerance, 0);
}

std::string shell_word(const std::string& word) {
  const auto plain = [](char ch) {
    return std::isalnum(static_cast<unsigned char>(ch)) || std::strchr("._-+:=,/@%", ch);
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string quoted = "'";
  for (const char ch : word) quoted += ch == '\'' ? std::string("'\\''") : std::string(1, ch);
  return quoted + "'";
}

std::string scientific(double value, int digits) {
  if (std::isnan(value)) return "unknown";
  if (std::isinf(value) || std::abs(value) >= std::numeric_limits<double>::max())
    return value > 0 ? "infinite" : "-infinite";
  if (value == 0) return "0";
  char text[32];
  std::snprintf(text, sizeof text, "%.*e", digits, value);
  std::string out = text;  // C pads exponents to two digits: 1e-08 reads better as 1e-8
  const std::size_t e = out.find('e');
  std::size_t first = out.find_first_not_of("0", e + 2);
  if (first == std::string::npos) return out.substr(0, e);
  return out.substr(0, e + 1) + (out[e + 1] == '-' ? "-" : "") + out.substr(first);
}

std::string duration(double seconds) {
  if (!std::isfinite(seconds)) return "unknown";
  constexpr std::pair<double, const char*> units[] = {{1, "s"}, {1e-3, "ms"}, {1e-6, "us"}, {1e-9, "ns"}};
  for (const auto& [size, unit] : units)
    if (seconds >= 0.9995 * size || size == 1e-9) {
      const double value = seconds / size;
      char text[32];
      std::snprintf(text, sizeof text, "%.*f %s", value < 9.95 ? 1 : 0, value, unit);
      return text;
    }
  return "";
}

}  // namespace zwang::report
