#include <zwang/bench/results/result.h>

#include <fcntl.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include <zwang/core/files/problem_file.h>

namespace zwang {
namespace {

using Json = nlohmann::ordered_json;

Json number(double x) {
  if (std::isnan(x)) return nullptr;
  return std::clamp(x, std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max());
}

Json number_or_null(Index x) { return x < 0 ? Json(nullptr) : Json(x); }

Json numbers(const Vector& v) {
  Json all = Json::array();
  for (const double x : v) all.push_back(number(x));
  return all;
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

std::string to_json(const Result& r, const Solution* with) {
  const Metrics& k = r.metrics;
  Json types = Json::array(), feasible = nullptr;
  for (const Result::WorstRow& worst : r.worst_by_type)
    types.push_back({{"type", worst.type},
                     {"violation", number(worst.violation)},
                     {"relative", number(worst.relative)},
                     {"unit", worst.unit},
                     {"row", worst.name}});
  if (r.feasible != Result::Feasible::unknown) feasible = r.feasible == Result::Feasible::yes;
  Json line = {{"problem", r.problem},
               {"family", r.family},
               {"knob", r.knob},
               {"knob_value", number(r.knob_value)},
               {"n", r.n},
               {"m", r.m},
               {"equalities", r.equalities},
               {"seed", r.seed},
               {"problem_sha256", r.problem_sha256},
               {"problem_file", r.problem_file},
               {"solver", r.solver},
               {"foreign", r.foreign},
               {"tolerance", number(r.tolerance)},
               {"claimed", to_string(r.claimed)},
               {"verified", to_string(k.verdict)},
               {"z_error", number(k.z_error)},
               {"z_bound", number(k.z_bound)},
               {"bound_method", k.bound_method},
               {"bound_sigma_min", number(k.bound_sigma_min)},
               {"primal", number(k.primal)},
               {"dual", number(k.dual)},
               {"stationarity", number(k.stationarity)},
               {"complementarity", number(k.complementarity)},
               {"gap", number(k.gap)},
               {"natural", number(k.natural)},
               {"scale", number(k.scale)},
               {"farkas", number(k.farkas)},
               {"setup_s", number(r.setup_s)},
               {"solve_s", number(r.solve_s)},
               {"solve_s_q1", number(r.solve_s_q1)},
               {"solve_s_q3", number(r.solve_s_q3)},
               {"prepare_s", number(r.prepare_s)},
               {"kernel_s", number(r.kernel_s)},
               {"allocations", number(r.allocations)},
               {"repetitions", r.repetitions},
               {"iterations", r.iterations},
               {"reference", r.reference.empty() ? Json(nullptr) : Json(r.reference)},
               {"reference_bound", number(r.reference_bound)},
               {"feasible", feasible},
               {"worst_row", r.worst_row},
               {"worst_by_type", types},
               {"rank", number_or_null(r.margins.rank)},
               {"smallest_pivot", number(r.margins.smallest_accepted)},
               {"largest_rejected_pivot", number(r.margins.largest_rejected)},
               {"redundant", r.redundant},
               {"conflicting", r.conflicting},
               {"fallback", r.fallback},
               {"handed_to", r.handed_to},
               {"range_gap", number(r.range_gap)},
               {"message", r.message},
               {"batch", r.batch}};
  if (with) {
    line["z"] = numbers(with->z);
    line["lambda"] = numbers(with->lambda);
  }
  return line.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void Tally::count(Status claimed, Verdict verdict) {
  ++runs;
  lies += zwang::lies(claimed, verdict);
  switch (verdict) {
    case Verdict::solved:
    case Verdict::infeasible_proven:
      ++solved;
      break;
    case Verdict::near:
      ++near;
      break;
    case Verdict::wrong:
      ++wrong;
      break;
    case Verdict::undecided:
    case Verdict::infeasible_claimed:
      ++undecided;
      break;
    case Verdict::unsupported:
      ++unsupported;
      break;
    case Verdict::no_answer:
    case Verdict::timeout:
    case Verdict::crashed:
    case Verdict::bad_input:
      ++failed;
      break;
  }
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
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  std::map<std::string, Status> status_of;
  for (int s = 0; s <= static_cast<int>(Status::crashed); ++s)
    status_of[std::string(to_string(static_cast<Status>(s)))] = static_cast<Status>(s);
  std::map<std::string, Verdict> verdict_of;
  for (int v = 0; v <= static_cast<int>(Verdict::unsupported); ++v)
    verdict_of[std::string(to_string(static_cast<Verdict>(v)))] = static_cast<Verdict>(v);

  std::size_t start = 0;
  int line_number = 1;
  for (std::size_t end; (end = text.find('\n', start)) != std::string::npos; start = end + 1, ++line_number) {
    try {
      const Json line = Json::parse(text.begin() + static_cast<std::ptrdiff_t>(start),
                                    text.begin() + static_cast<std::ptrdiff_t>(end));
      stored.finished.emplace(line.at("problem_file"), line.at("solver"), line.at("tolerance"));
      stored.tally.count(status_of.at(line.at("claimed")), verdict_of.at(line.at("verified")));
    } catch (const std::exception&) {
      throw BadFile(file.string() + ", line " + std::to_string(line_number) + ": not a line of results");
    }
  }
  if (start < text.size()) std::filesystem::resize_file(file, start);
  return stored;
}

}  // namespace zwang
