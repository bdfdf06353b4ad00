#include <zwang/bench/results/result.h>

#include <fcntl.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>

#include <zwang/bench/results/recorded.h>
#include <zwang/bench/results/seal.h>
#include <zwang/core/files/problem_file.h>

namespace zwang {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no infinity: the largest number stands for it. NaN becomes null.
double known(double x) {
  return std::clamp(x, std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max());
}

void put(Json&) {}

// Sets a key, its value, a key, its value, ...
template <class Value, class... Rest>
void put(Json& object, const char* key, const Value& value, const Rest&... rest) {
  if constexpr (std::is_same_v<Value, double>)
    object[key] = known(value);
  else
    object[key] = value;
  put(object, rest...);
}

Json numbers(const Vector& v) {
  Json all = Json::array();
  for (const double x : v) all.push_back(known(x));
  return all;
}

// The value of the enum whose name this is. Throws std::out_of_range.
template <class Enum>
Enum named(const std::string& name, Enum last) {
  for (int k = 0; k <= static_cast<int>(last); ++k)
    if (to_string(static_cast<Enum>(k)) == name) return static_cast<Enum>(k);
  throw std::out_of_range(name);
}

}  // namespace

bool lies(Status claimed, Verdict verdict) {
  return (claimed == Status::solved || claimed == Status::infeasible) && verdict == Verdict::wrong;
}

Result describe(const Instance& instance) {
  const Problem& p = instance.problem;
  Result r;
  r.problem = p.name;
  r.family = instance.family;
  r.knob = instance.knob;
  r.knob_value = instance.knob_value;
  r.n = p.size();
  r.m = p.rows();
  r.equalities = std::count(p.kind.begin(), p.kind.end(), RowKind::equality);
  r.seed = instance.seed;
  r.problem_sha256 = problem_sha256(p);
  r.law = to_string(p.law);
  if (instance.reference) {
    r.reference = instance.reference->method;
    r.reference_bound = instance.reference->bound;
    r.feasible = instance.reference->feasible ? Result::Feasible::yes : Result::Feasible::no;
  }
  return r;
}

void judge(Result& r, const Instance& instance, const Solution& solution) {
  r.claimed = solution.status;
  r.metrics = measure(instance.problem, solution, instance.reference ? &*instance.reference : nullptr, r.tolerance);
  r.worst_row = row_name(instance, r.metrics.worst_row);
  if (solution.z.size() == instance.problem.size() && solution.z.allFinite() && solution.z.size() > 0)
    for (TypeResidual& worst : worst_by_type(instance, solution.z)) {
      const auto row = static_cast<std::size_t>(worst.row);
      const std::string unit = row < instance.origin.size() ? instance.origin[row].unit : "";
      r.worst_by_type.push_back({std::move(worst), row_name(instance, worst.row), unit});
    }
  for (const Index i : r.metrics.conflicting) r.conflicting.push_back(row_name(instance, i));
  r.iterations = solution.iterations;
  r.margins = solution.margins;
  r.redundant = solution.redundant.size();
  r.fallback = solution.fallback;
  r.handed_to = solution.handed_to;
  r.message = solution.message;
  r.range_gap = solution.range_gap;
}

Result judge_recorded(Result r, const Instance& instance, const RecordedAnswer& answer, double tolerance) {
  r.solver = recorded_name(answer.by);
  r.tolerance = tolerance;
  Solution given;
  given.status = Status::solved;
  given.z = answer.z;
  judge(r, instance, given);
  r.claimed = Status::unsolved;
  return r;
}

std::string to_json(const Result& r, const Solution* with) {
  const Metrics& k = r.metrics;
  Json types = Json::array();
  for (const Result::WorstRow& w : r.worst_by_type)
    put(types.emplace_back(), "type", w.type, "violation", w.violation, "relative", w.relative, "unit", w.unit, "row",
        w.name);
  const Json reference = r.reference.empty() ? Json() : Json(r.reference);
  const Json feasible = r.feasible == Result::Feasible::unknown ? Json() : Json(r.feasible == Result::Feasible::yes);
  Json line;
  put(line, "problem", r.problem, "family", r.family, "knob", r.knob, "knob_value", r.knob_value, "n", r.n, "m", r.m,
      "equalities", r.equalities, "seed", r.seed, "problem_sha256", r.problem_sha256, "problem_file", r.problem_file,
      "law", r.law, "solver", r.solver, "foreign", r.foreign, "tolerance", r.tolerance, "claimed", to_string(r.claimed),
      "verified", to_string(k.verdict));
  put(line, "z_error", k.z_error, "z_bound", k.z_bound, "bound_method", k.bound_method, "bound_sigma_min",
      k.bound_sigma_min, "primal", k.primal, "dual", k.dual, "stationarity", k.stationarity, "complementarity",
      k.complementarity, "gap", k.gap, "natural", k.natural, "scale", k.scale, "farkas", k.farkas);
  if (const FrictionMetrics& f = k.friction; r.law == to_string(Law::coulomb) || r.law == to_string(Law::convex))
    put(line, "penetration", f.penetration, "cone_violation", f.cone_violation, "dissipation", f.dissipation, "eta",
        f.eta, "self_bound", f.self_bound, "radius", f.radius, "delta", f.delta, "null_motion", f.null_motion,
        "isolated", f.isolated);
  if (std::isfinite(r.coulomb_error)) put(line, "coulomb_error", r.coulomb_error);
  put(line, "setup_s", r.setup_s, "solve_s", r.solve_s, "solve_s_q1", r.solve_s_q1, "solve_s_q3", r.solve_s_q3,
      "prepare_s", r.prepare_s, "kernel_s", r.kernel_s, "allocations", r.allocations, "repetitions", r.repetitions,
      "iterations", r.iterations);
  put(line, "reference", reference, "reference_bound", r.reference_bound, "feasible", feasible, "worst_row",
      r.worst_row, "worst_by_type", types, "rank", r.margins.rank < 0 ? Json() : Json(r.margins.rank), "smallest_pivot",
      r.margins.smallest_accepted, "largest_rejected_pivot", r.margins.largest_rejected, "redundant", r.redundant,
      "conflicting", r.conflicting, "fallback", r.fallback, "handed_to", r.handed_to, "range_gap", r.range_gap,
      "message", r.message, "batch", r.batch);
  if (with) put(line, "z", numbers(with->z), "lambda", numbers(with->lambda));
  return line.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string to_record(const Result& result, const std::string& cell) {
  std::string line = to_json(result);
  line.pop_back();
  return sealed(line + ",\"machine\":" + Json(result.machine).dump() + ",\"cell\":\"" + cell + "\"}");
}

void Tally::count(std::string_view solver, Status claimed, Verdict verdict) {
  if (is_recorded(solver)) {
    ++recorded;
    return;
  }
  const auto part = [&]() -> std::size_t& {
    switch (verdict) {
      case Verdict::solved:
      case Verdict::infeasible_proven:
        return solved;
      case Verdict::near:
        return near;
      case Verdict::wrong:
        return wrong;
      case Verdict::undecided:
      case Verdict::consistent:
      case Verdict::rows_off:
      case Verdict::infeasible_claimed:
        return undecided;
      case Verdict::unsupported:
        return unsupported;
      default:
        return failed;
    }
  };
  ++runs;
  ++part();
  lies += zwang::lies(claimed, verdict);
}

ResultFile::ResultFile(const std::filesystem::path& file)
    : file_(open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {
  if (file_ < 0) throw std::system_error(errno, std::generic_category(), file.string());
}

ResultFile::~ResultFile() { close(file_); }

void ResultFile::append(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t written = write(file_, text.data() + at, text.size() - at);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw std::system_error(errno, std::generic_category(), "writing results");
    at += static_cast<std::size_t>(written);
  }
  fsync(file_);
}

Stored load_results(const std::filesystem::path& file) {
  Stored stored;
  std::ifstream in(file, std::ios::binary);
  std::uintmax_t whole = 0;
  for (std::string line; std::getline(in, line);) {
    if (in.eof()) {
      in.close();
      std::filesystem::resize_file(file, whole);
      break;
    }
    whole += line.size() + 1;
    const Json record = is_intact(line) ? Json::parse(line, nullptr, false) : Json();
    try {
      const Status claimed = named(record.at("claimed"), Status::crashed);
      const Verdict verdict = named(record.at("verified"), last_verdict);
      if (stored.finished.insert(record.at("cell")).second)
        stored.tally.count(record.at("solver").get_ref<const std::string&>(), claimed, verdict);
    } catch (const std::exception&) {
      ++stored.damaged;
    }
  }
  return stored;
}

}  // namespace zwang
