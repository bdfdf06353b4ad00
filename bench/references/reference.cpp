#include <zwang/bench/references/reference.h>

#include <algorithm>
#include <numbers>
#include <span>

#include <zwang/bench/references/cache.h>
#include <zwang/bench/references/friction/coulomb.h>
#include <zwang/bench/references/friction/exact_solutions.h>
#include <zwang/bench/references/witnesses.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/referee/friction/law.h>
#include <zwang/core/referee/island_split.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

constexpr Index multiprecision_limit = 300, rational_limit = 96, extended_limit = 1200;

FoundReference compute(const Problem& problem, bool second_witness);

// Parts that share nothing are known apart: 64 hands are 64 problems of 96 unknowns. Each part's bound is relative to
// its own s, and the sum of s^2 over the parts is at most twice that of the whole. The referee looks at the whole.
FoundReference compute_by_islands(const Problem& problem, std::span<const IslandPart> islands, bool second_witness) {
  const auto refuted = [&](const Reference& r) { return check_stored(problem, r).standing == Standing::refuted; };
  const FoundReference split_wrong{.note = "the referee refutes what the islands' references are together"};
  Reference whole{.z = problem.z_u, .lambda = Vector::Zero(problem.rows())};
  for (const IslandPart& island : islands) {
    if (island.rows.empty()) continue;
    FoundReference part = compute(island.problem, second_witness);
    if (!part.reference) return part;
    const Reference& found = *part.reference;
    const auto scatter = [](const Vector& from, const std::vector<Index>& to, Vector& into) {
      if (from.size() != std::ssize(to)) into.resize(0);
      if (into.size() > 0) into(to) = from;
    };
    if (!found.feasible) {
      Reference infeasible{.feasible = false, .certificate = Vector::Zero(problem.rows()), .method = found.method};
      scatter(found.certificate, island.rows, infeasible.certificate);
      return refuted(infeasible) ? split_wrong : FoundReference{.reference = infeasible};
    }
    scatter(found.z, island.columns, whole.z);
    scatter(found.lambda, island.rows, whole.lambda);
    whole.bound = std::max(whole.bound, found.bound * std::numbers::sqrt2 * (1 + referee::widened));
    whole.unique &= found.unique;
    if (whole.method.empty()) whole.method = found.method + ", island by island";
  }
  return refuted(whole) ? split_wrong : FoundReference{.reference = whole};
}

// Interval Newton, and enumeration where the problem is planar and small: it knows all solutions, and shares nothing
// with the other.
FoundReference under_coulomb(const Problem& problem) {
  FoundReference found;
  found.reference = coulomb_reference(problem, &found.note);
  const std::optional<ExactSolutions> all = enumerate_planar(problem);
  if (!all || !all->complete()) return found;
  const auto& solutions = all->solutions();
  const std::string method = "every choice of modes in rationals";
  if (!found.reference) {
    if (solutions.empty()) return {.reference = Reference{.feasible = false, .method = method}};
    found.reference = Reference{.z = solutions[0].z, .bound = rounding_of(problem, solutions[0].z), .method = method};
  } else {
    const Reference& own = *found.reference;
    if (std::ranges::none_of(solutions, [&](const ExactSolutions::Rounded& one) {
          return relative_distance(problem, own.z, one.z) <= 2 * (own.bound + rounding_of(problem, one.z));
        }))
      return {.note = "interval Newton and enumeration disagree"};
    found.reference->method += ", " + method;
  }
  found.reference->unique = solutions.size() == 1;
  return found;
}

FoundReference compute(const Problem& problem, bool second_witness) {
  const Index n = problem.size(), m = problem.rows();
  if (problem.has_tangents() || n > multiprecision_limit)
    if (const auto islands = split_islands(problem); !islands.empty())
      return compute_by_islands(problem, islands, second_witness);
  if (problem.has_tangents()) {
    if (!referee::may_prove(n, m))
      return {.note = std::to_string(n) + " unknowns and " + std::to_string(m) +
                      " rows that hang together; proofs are dense, up to " + std::to_string(referee::dense_limit) +
                      " and " + std::to_string(referee::dense_rows)};
    if (referee::slip_lifts(problem.law)) return under_coulomb(problem);
    FoundReference found;
    found.reference = convex_reference(problem, &found.note);
    return found;
  }
  if (problem.size() > extended_limit) return {.note = "no reference beyond n = 1200"};
  if (problem.size() > multiprecision_limit) {
    FoundReference found{.reference = extended_reference(problem)};
    if (!found.reference) found.note = "the active-set bound does not certify the long double answer";
    return found;
  }
  FoundReference found;
  found.reference = multiprecision_reference(problem, &found.note);
  if (!found.reference || !second_witness) return found;

  const std::optional<Reference> witness = rational_reference(problem);
  Reference& first = *found.reference;
  if (!witness) return {.note = "CGAL's solver gave no answer"};
  if (witness->feasible != first.feasible ||
      (first.feasible && !(relative_distance(problem, first.z, witness->z) <= referee::rounded_once)))
    return {.note = "mpfr and CGAL disagree"};
  first.method += " + CGAL exact";
  return found;
}

// A closed form or a known answer: kept unless the referee refutes it, or the 100-digit method disagrees. A file's
// truth: kept where the referee proves it, otherwise found anew.
FoundReference confirm(const Problem& problem, Reference own, bool second_witness) {
  if (own.hearsay || problem.size() <= multiprecision_limit) {
    const auto [standing, bound] = check_stored(problem, own);
    if (standing == Standing::refuted) return {.note = "the referee refutes the " + own.method};
    const bool coulomb = referee::slip_lifts(problem.law) && problem.has_tangents();
    if (own.hearsay && standing == Standing::open) {
      FoundReference found = compute(problem, second_witness);
      if (!found.reference) found.note = "nothing proves the " + own.method + "; " + found.note;
      return found;
    }
    if (standing == Standing::certified) own.bound = std::max(own.bound, bound);
    if (own.hearsay && own.unique && coulomb) {
      const std::optional<ExactSolutions> all = enumerate_planar(problem);
      own.unique = all && all->complete() && all->solutions().size() == 1;
    }
    own.hearsay = false;
    if (standing == Standing::certified && own.method.find("certified") == std::string::npos)
      own.method += ", certified by the referee";
  }
  if (!second_witness) return {.reference = own};
  const std::optional<Reference> digits = multiprecision_reference(problem);
  if (!digits) return {.reference = own};
  if (digits->feasible != own.feasible ||
      (own.feasible && !(relative_distance(problem, own.z, digits->z) <= own.bound + referee::rounded_once)))
    return {.note = "the " + own.method + " and mpfr disagree"};
  own.method += " + " + digits->method;
  return {.reference = own};
}

bool fits(const Reference& r, const Problem& p) {
  return r.feasible ? r.z.size() == p.size() : r.certificate.size() == p.rows();
}

}  // namespace

FoundReference reference_for(const Instance& instance, const std::filesystem::path& cache_dir,
                             const ReferenceOptions& options) {
  const Problem& problem = instance.problem;
  const bool second_witness =
      has_rational_reference && options.second_witness && problem.size() <= rational_limit && !problem.has_tangents();
  if (instance.reference) return confirm(problem, *instance.reference, second_witness);
  if (cache_dir.empty()) return compute(problem, second_witness);

  const std::filesystem::path file =
      cache_dir / (problem_sha256(problem) + "-" + std::string(reference_sources.substr(0, 16)) +
                   (second_witness ? "-two" : "") + ".reference");
  if (std::optional<Reference> kept = read_cached(file);
      kept && fits(*kept, problem) && check_stored(problem, *kept).standing != Standing::refuted)
    return {.reference = kept};
  FoundReference found = compute(problem, second_witness);
  try {
    if (found.reference) write_cached(file, *found.reference);
  } catch (const std::exception&) {
    // A cache that cannot be written costs time, and nothing else.
  }
  return found;
}

}  // namespace zwang
