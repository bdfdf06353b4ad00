#include <zwang/bench/results/result.h>

#include <fcntl.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <fstream>
#include <map>
#include <system_error>

#include <zwang/bench/results/seal.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/process/child_process.h>
#include <zwang/core/referee/scaled_problem.h>

namespace zwang {

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
    r.feasible = instance.reference->feasible;
  }
  return r;
}

namespace {

// A bound holds up to the rounding of who measures it. Under Coulomb's law it is on the distance to the convex answer
// of z's own slips, of which the referee knows an upper bound alone.
std::string kept(const Problem& problem, const Metrics& m, const Reference* reference, double promised) {
  const double rounding = accepted_error(0), most = promised + rounding;
  if (problem.has_tangents() && !is_convex(problem.law)) return m.friction.self_bound <= most ? "kept" : "undecided";
  if (m.z_bound <= most) return "kept";
  if (!reference || std::isnan(m.z_error)) return "undecided";
  const ErrorBounds proven = error_bounds(problem, *reference, m.z_error);
  return proven.upper <= most ? "kept" : proven.lower > most ? "broken" : "undecided";
}

}  // namespace

std::vector<WorstRow> worst_by_type(const Instance& instance, const Vector& z) {
  const Problem& p = instance.problem;
  const ScaledProblem scaled(p);
  const ExtendedVector d = scaled.motion(z);
  const double s = scaled.scale_of(scaled.norm_of(z));
  std::map<std::string, WorstRow> worst;
  for (Index i = 0; i < p.rows(); ++i) {
    if (p.is_tangent(i)) continue;  // a slip violates nothing
    const RowOrigin* origin = at(i) < instance.origin.size() ? &instance.origin[at(i)] : nullptr;
    double violation = 0, relative = 0;
    if (!scaled.is_vacuous(i)) {
      const double slack = scaled.slack(i, d).hi;
      violation = scaled.is_equality(i) ? std::abs(slack) : std::max(-slack, 0.0);
      if (violation > 0) relative = violation / scaled.row_norm[i] / s;
      violation *= scaled.row_scale(i);
    }
    const std::string type = origin ? origin->type : "row";
    const auto [it, first] = worst.try_emplace(type);
    if (first || relative > it->second.relative)
      it->second = {type, violation, relative, row_name(instance, i), origin ? origin->unit : ""};
  }
  return mapped(worst, [](const auto& typed) { return typed.second; });
}

void judge(Result& r, const Instance& instance, const Solution& solution) {
  r.claimed = solution.status;
  const Reference* reference = instance.reference ? &*instance.reference : nullptr;
  r.metrics = measure(instance.problem, solution, reference, claimed_tolerance(solution, r.tolerance));
  r.error_bound = solution.error_bound;
  if (std::isfinite(r.error_bound)) r.promise = kept(instance.problem, r.metrics, reference, r.error_bound);
  r.worst_row = row_name(instance, r.metrics.worst_row);
  if (solution.z.size() == instance.problem.size() && solution.z.allFinite() && solution.z.size() > 0)
    r.worst_by_type = worst_by_type(instance, solution.z);
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
  r.solver = std::string(Result::recorded) + answer.by;
  r.tolerance = tolerance;
  judge(r, instance, {.status = Status::solved, .z = answer.z});
  r.claimed = Status::unsolved;
  return r;
}

void Tally::count(const Result& result) {
  if (result.is_recorded()) {
    ++recorded;
    return;
  }
  const Verdict verdict = result.metrics.verdict;
  ++runs;
  ++(result.is_right()                                            ? solved
     : verdict == Verdict::near                                   ? near
     : verdict == Verdict::wrong                                  ? wrong
     : result.is_open() || verdict == Verdict::infeasible_claimed ? undecided
     : verdict == Verdict::unsupported                            ? unsupported
                                                                  : failed);
  lies += result.lies();
}

ResultFile::ResultFile(const std::filesystem::path& file, bool anew)
    : file_(open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | (anew ? O_TRUNC : 0), 0666)) {
  if (file_ < 0) throw std::system_error(errno, std::generic_category(), file.string());
}

ResultFile::~ResultFile() { close(file_); }

void ResultFile::append(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  if (!transfer(text.size(), [&](std::size_t done) { return write(file_, text.data() + done, text.size() - done); }))
    throw std::system_error(errno, std::generic_category(), "writing results");
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
    try {
      const Result result = is_intact(line) ? read_result(line) : Result();
      if (result.cell.empty())
        ++stored.damaged;
      else if (stored.finished.insert(result.cell).second)
        stored.tally.count(result);
    } catch (const std::exception&) {
      ++stored.damaged;
    }
  }
  return stored;
}

}  // namespace zwang
