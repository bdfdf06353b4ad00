#include <zwang/bench/fuzz/fuzz.h>

#include <cmath>
#include <stdexcept>

#include <zwang/bench/fuzz/frictional_problem.h>
#include <zwang/bench/fuzz/question_referee.h>
#include <zwang/bench/fuzz/small_problem.h>
#include <zwang/bench/references/friction/coulomb.h>
#include <zwang/bench/references/friction/exact_solutions.h>
#include <zwang/bench/references/witnesses.h>
#include <zwang/bench/scenes/dyadic.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/problem/wording.h>
#include <zwang/core/referee/measure.h>

namespace zwang {
namespace {

constexpr double tolerance = 1e-10, exact_limit = 1e-9, other_limit = 1e4 * tolerance, warm_limit = 1e-12;
constexpr int patience = 500, frames = 256;  // iterations of first-order methods; of a film
constexpr std::uint64_t warm_every = 4, spoil_every = 8, film_every = 2000;

// |a - b|_M / max(|z_u|_M, |b|_M).
double distance(const Problem& p, const Vector& a, const Vector& b) {
  if (a.size() != b.size() || !a.allFinite()) return std::numeric_limits<double>::infinity();
  const auto length = [&](const Vector& v) { return std::sqrt(std::max(0., v.dot(p.M * v))); };
  const double apart = length(a - b);
  return apart == 0 ? 0 : apart / std::max(length(p.z_u), length(b));
}

bool has_z(Status status) { return status == Status::solved || status == Status::solved_ill_conditioned; }

// Where rationals and 100 digits disagree, less than 1e-100 of the numbers decides: nothing is asked of doubles then.
std::optional<Reference> decided_by_both(const Problem& p) {
  const auto rational = rational_reference(p), digits = multiprecision_reference(p);
  if (!rational || !digits || rational->feasible != digits->feasible) return {};
  if (digits->feasible && !(relative_distance(p, rational->z, digits->z) <= warm_limit)) return {};
  return digits;
}

// What contradicts a claim on a problem with an extreme entry. Two cases are not counted as faults: an answer that no
// double holds, and a contradiction between rows that is smaller than the rounding of their terms.
std::string contradiction(const Problem& p, const Solution& s, const Reference& truth) {
  if (truth.feasible && !truth.z.allFinite()) return "";
  if (s.status == Status::infeasible) return truth.feasible ? ", but it is feasible" : "";
  const Metrics metrics = measure(p, s, &truth, tolerance);
  if (truth.feasible) return metrics.z_error <= other_limit ? "" : ", but z is another one";
  return metrics.primal <= other_limit ? "" : ", but no z meets the rows";
}

// What no solver should say of a sound problem; "": anything else.
std::string misbehaviour(const Solution& s) {
  if (s.status == Status::bad_input) return "says bad input: " + s.message;
  return s.message.starts_with("threw: ") ? s.message : "";
}

// The convex problem of z's own slips, whose answer promises are about where slip lifts.
Problem of_slips(Problem p, const Vector& z) {
  const Vector s = p.J * z - p.c;
  for (Index i = 0; i < p.rows(); ++i)
    if (!p.is_tangent(i)) p.c[i] -= p.mu[i] * s.segment(i + 1, p.tangents(i)).norm();
  p.law = without_lift(p.law);
  return p;
}

std::string shown(const char* what, double value) { return printed("%s %g", what, value); }

}  // namespace

Instance fuzzed(const FuzzOptions& options, std::uint64_t number) {
  if (options.friction && !options.accuracy.empty())
    return planted_problem(options.seed, number, without_lift(stored_law));
  if (options.friction)  // there may be several answers, or none
    return {.problem = frictional_problem(options.seed, number)};
  Instance out;
  out.problem = options.near ? near_problem(options.seed, number) : small_problem(options.seed, number);
  std::string why_not;
  out.reference = multiprecision_reference(out.problem, &why_not);
  // 100 digits decide problems of these kinds; if they did not, the problem would be no test.
  if (!out.reference) throw std::logic_error(out.problem.name + " has no truth: " + why_not);
  return out;
}

// Native solvers; only on request one that sees no infeasibility, and on near-dependent rows one that stops where a
// residual is small: there a small one says nothing of z.
std::vector<std::string> fuzzed_solvers(const FuzzOptions& options, std::span<const SolverEntry> among) {
  std::vector<std::string> names;
  if (options.referee) return {referee_classes.begin(), referee_classes.end()};
  if (!options.solvers.empty()) return split(options.solvers);
  const auto reads = [&](const SolverEntry& e) {
    return e.reads(stored_law) || (!options.accuracy.empty() && e.reads(without_lift(stored_law)));
  };
  for (const SolverEntry& e : among)
    if (!e.foreign && (options.friction ? reads(e) : e.sees_infeasibility) &&
        !(options.near && e.accuracy.solved_share < 1))
      names.push_back(e.name);
  return names;
}

Fuzzer::Fuzzer(const FuzzOptions& options, std::span<const SolverEntry> among, std::span<FuzzTally> tally,
               std::function<void(std::size_t)> at, std::function<void(Fault)> report)
    : options_(options),
      names_(fuzzed_solvers(options, among)),
      tally_(tally),
      at_(std::move(at)),
      report_(std::move(report)) {
  for (const std::string& name : names_) {
    if (options.referee) break;
    AnySolver solver = make_solver(name, among);
    const bool exact = find_solver(name, among)->exact, alone = name.find("polish=off") != std::string::npos;
    candidates_.push_back({name, exact, exact && !alone, std::move(solver)});
  }
  if (tally_.size() < candidates_.size()) throw std::invalid_argument("fuzzing: more solvers than tallies");
}

void Fuzzer::fault(std::size_t i, std::uint64_t number, std::string what, Problem problem, const Reference* truth) {
  ++tally_[i].faults;
  Fault out{.number = number, .solver = names_[i], .what = std::move(what)};
  out.instance.problem = std::move(problem);
  out.instance.family = "fuzz";
  out.instance.seed = options_.seed;
  if (truth) out.instance.reference = *truth;
  report_(std::move(out));
}

const Solution& Fuzzer::solve(std::size_t i, const Problem& problem, const WarmStart* warm) {
  at_(i);
  Candidate& c = candidates_[i];
  SolveOptions options{.tolerance = tolerance, .warm_start = warm};
  options.read_accuracy(options_.accuracy);
  if (!c.exact) options.max_iterations = patience;
  const double start = wall_seconds();
  c.solver.solve(problem, options, c.solution);
  tally_[i].seconds += wall_seconds() - start;
  return c.solution;
}

void Fuzzer::against_truth(std::uint64_t number, const Problem& problem, const Reference& truth) {
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const Solution& s = solve(i, problem);
    FuzzTally& t = tally_[i];
    if (s.status == Status::unsupported) continue;
    ++t.runs;
    if (s.status == Status::infeasible) {
      if (truth.feasible)
        fault(i, number, "says infeasible of a feasible problem", problem, &truth);
      else if (measure(problem, s, &truth, tolerance).verdict == Verdict::infeasible_proven)
        ++t.proven;
      else if (candidates_[i].exact)
        fault(i, number, "its certificate proves nothing", problem, &truth);
      else
        ++t.undecided;
    } else if (has_z(s.status)) {
      const double error = truth.feasible ? distance(problem, s.z, truth.z) : std::numeric_limits<double>::infinity();
      weigh_promise(i, number, problem, truth, error);
      const double limit = candidates_[i].exact ? exact_limit : other_limit;
      const bool right = error <= (std::isfinite(s.error_bound) ? std::max(limit, s.error_bound) : limit);
      if (right && s.status == Status::solved) {
        ++t.solved;
        t.worst_z_error = std::max(t.worst_z_error, error);
      } else if (right) {
        ++t.flagged;
      } else if (s.status == Status::solved) {
        fault(i, number,
              truth.feasible ? shown("says solved with z error", error) : "says solved of an infeasible problem",
              problem, &truth);
      } else {
        ++t.undecided;
      }
    } else if (const std::string wrong = misbehaviour(s); !wrong.empty()) {
      fault(i, number, wrong, problem, &truth);
    } else {
      ++t.undecided;
    }
  }
}

void Fuzzer::weigh_promise(std::size_t i, std::uint64_t number, const Problem& p, const Reference& truth, double off) {
  const double bound = candidates_[i].solution.error_bound;
  if (!std::isfinite(bound)) return;
  ++tally_[i].promised;
  tally_[i].tight += bound <= 10 * std::max(off, warm_limit);
  if (!(off <= bound + truth.bound + warm_limit))
    fault(i, number, shown("promises", bound) + shown(", z error", off), p, &truth);
}

void Fuzzer::promised_under_friction(std::uint64_t number, const Problem& problem) {
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const Solution& s = solve(i, problem);
    if (s.status == Status::unsupported) continue;
    ++tally_[i].runs;
    if (const std::string wrong = misbehaviour(s); !wrong.empty()) fault(i, number, wrong, problem);
    const auto truth = std::isfinite(s.error_bound) ? convex_reference(of_slips(problem, s.z)) : std::nullopt;
    if (truth) weigh_promise(i, number, problem, *truth, distance(problem, s.z, truth->z));
    ++(truth ? tally_[i].solved : tally_[i].undecided);
  }
}

// One problem may have several answers: the referee judges each, and enumeration knows all of a planar one.
void Fuzzer::under_friction(std::uint64_t number, const Problem& problem) {
  constexpr Index few_contacts = 4;
  const bool planar = std::ranges::count(problem.kind, RowKind::tangent) <= few_contacts;
  const std::optional<ExactSolutions> all = planar ? enumerate_planar(problem) : std::nullopt;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const Solution& s = solve(i, problem);
    FuzzTally& t = tally_[i];
    ++t.runs;
    if (const std::string wrong = misbehaviour(s); !wrong.empty()) fault(i, number, wrong, problem);
    if (s.status != Status::infeasible && !has_z(s.status)) {
      ++t.undecided;
      continue;
    }
    const Verdict verdict = measure(problem, s, nullptr, tolerance).verdict;
    if (s.status == Status::infeasible) {
      if (verdict == Verdict::wrong || (all && (!all->complete() || !all->solutions().empty())))
        fault(i, number, "says infeasible of a problem that has an answer", problem);
      else
        ++(verdict == Verdict::infeasible_proven ? t.proven : t.undecided);
      continue;
    }
    double error = std::numeric_limits<double>::infinity();
    if (all && all->complete()) {
      for (const auto& [z, lambda] : all->solutions()) error = std::min(error, distance(problem, s.z, z));
      if (!(error <= other_limit)) {
        fault(i, number, shown("says solved, farther from every answer than", error), problem);
        continue;
      }
      t.worst_z_error = std::max(t.worst_z_error, error);
    }
    if (verdict == Verdict::wrong)
      fault(i, number, "says solved, and the referee refutes it", problem);
    else
      ++(verdict == Verdict::solved || verdict == Verdict::consistent ? t.solved : t.flagged);
  }
}

void Fuzzer::with_spoilt_friction(std::uint64_t number, Problem problem) {
  Draw draw(static_cast<double>(number % (std::uint64_t{1} << 50)));
  // The last normal row: mu is read nowhere else.
  Index row = problem.rows() - 1;
  while (problem.is_tangent(row)) --row;
  constexpr const char* ways[] = {"mu = -1", "mu = nan", "a tangent row without its contact", "mu is short"};
  const auto way = static_cast<std::size_t>(draw.integer(0, 3));
  if (way == 0) problem.mu[row] = -1;
  if (way == 1) problem.mu[row] = std::numeric_limits<double>::quiet_NaN();
  if (way == 2) problem.kind[0] = RowKind::tangent;
  if (way == 3) problem.mu.conservativeResize(problem.rows() - 1);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    std::string claim;
    try {
      claim = to_string(solve(i, problem).status);
    } catch (const std::invalid_argument&) {  // sizes that do not match are wrong use
      claim = to_string(Status::bad_input);
    }
    ++tally_[i].spoilt;
    if (claim != to_string(Status::bad_input)) fault(i, number, ways[way] + (": says " + claim), problem);
  }
}

// Multipliers that fit nothing: of a few of the rows, of rows that do not exist, of the wrong sign.
void Fuzzer::from_random_multipliers(std::uint64_t number, const Problem& problem) {
  Draw draw(static_cast<double>(number % (std::uint64_t{1} << 50)));
  WarmStart warm;
  for (const RowKey& key : problem.key)
    if (draw.integer(0, 1)) warm.key.push_back(key);
  if (draw.integer(0, 3) == 0) warm.key.push_back({999, 7});
  warm.lambda = draw.integers(static_cast<Index>(warm.key.size()), 3);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (!candidates_[i].repeats) continue;
    const Solution cold = candidates_[i].solution;
    const Solution& s = solve(i, problem, &warm);
    ++tally_[i].warm;
    if (!has_z(cold.status) && cold.status != Status::infeasible) continue;
    const bool same = has_z(cold.status) ? has_z(s.status) && distance(problem, s.z, cold.z) <= warm_limit
                                         : s.status == Status::infeasible;
    if (same) continue;
    std::string what = "warm start: cold ";
    what.append(to_string(cold.status)).append(", warm ").append(to_string(s.status));
    what += shown(", z apart by", distance(problem, s.z, cold.z)) + ", from lambda";
    for (std::size_t k = 0; k < warm.key.size(); ++k)
      what += " " + std::to_string(warm.key[k].constraint) + printed(":%g", warm.lambda[static_cast<Index>(k)]);
    fault(i, number, what, problem);
  }
}

void Fuzzer::with_spoilt_entry(std::uint64_t number, const Problem& problem) {
  const Spoilt spoilt = spoil(problem, options_.seed + number);
  const bool bad = spoilt.bad || !is_positive_definite(spoilt.problem.M);
  const std::optional<Reference> truth = bad ? std::nullopt : decided_by_both(spoilt.problem);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const Solution& s = solve(i, spoilt.problem);
    ++tally_[i].spoilt;
    const std::string claim = spoilt.what + ": says " + std::string(to_string(s.status));
    if (bad && s.status != Status::bad_input) fault(i, number, claim, spoilt.problem);
    if (bad || (s.status != Status::solved && s.status != Status::infeasible)) continue;
    const std::string wrong = truth ? contradiction(spoilt.problem, s, *truth) : "";
    if (!wrong.empty()) fault(i, number, claim + wrong, spoilt.problem, &*truth);
  }
}

void Fuzzer::film(std::uint64_t number) {
  const std::uint64_t reel = number / film_every;
  Knobs knobs = {
      {"k", static_cast<double>(3 + reel % 46)}, {"frame", 0}, {"seed", static_cast<double>(options_.seed + reel)}};
  std::vector<WarmStart> before(candidates_.size());
  for (int frame = 0; frame < frames; ++frame) {
    knobs["frame"] = frame;
    Problem p = flipping_stack(knobs).problem;
    p.name = "FLIP(k=" + std::to_string(3 + reel % 46) + ",seed=" + std::to_string(options_.seed + reel) +
             ",frame=" + std::to_string(frame) + ")";
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (!candidates_[i].repeats) continue;
      const Solution cold = solve(i, p), &s = solve(i, p, frame > 0 ? &before[i] : nullptr);
      ++tally_[i].warm;
      const double apart = distance(p, s.z, cold.z);
      if (!has_z(cold.status) || !has_z(s.status) || !(apart <= warm_limit))
        fault(i, number, "warm start from the frame before: " + shown("z apart by", apart), p);
      before[i] = {p.key, s.lambda};
    }
  }
}

void Fuzzer::look(std::uint64_t number) {
  if (options_.referee) {
    const std::size_t i = referee_class(number);
    at_(i);
    const double start = wall_seconds();
    question_referee(options_.seed, number, tally_[i],
                     [&](std::string what, Instance asked) { fault(i, number, std::move(what), asked.problem); });
    tally_[i].seconds += wall_seconds() - start;
    return;
  }
  const Instance asked = fuzzed(options_, number);
  const Problem& problem = asked.problem;
  if (!asked.reference) {
    under_friction(number, problem);
    if (number % spoil_every == 0) with_spoilt_friction(number, problem);
    return;
  }
  against_truth(number, problem, *asked.reference);
  if (options_.friction) promised_under_friction(number, frictional_problem(options_.seed, number));
  // Answers that are good enough differ from start to start by what is promised.
  if (options_.near || !options_.accuracy.empty()) return;
  if (number % warm_every == 0) from_random_multipliers(number, problem);
  if (number % spoil_every == 0) with_spoilt_entry(number, problem);
  if (number % film_every == 0) film(number);
}

}  // namespace zwang
