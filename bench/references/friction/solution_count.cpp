#include <zwang/bench/references/friction/solution_count.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <zwang/bench/references/friction/exact_solutions.h>
#include <zwang/bench/references/witnesses.h>

namespace zwang {
namespace {

constexpr int random_starts = 40;
constexpr int mode_choices = 729;  // three modes each of six contacts

// Of the searches' solutions those that enumeration confirms, and what it knows beyond them.
std::vector<CoulombSolution> confirmed(const Problem& problem, const ExactSolutions& exact,
                                       const std::vector<CoulombSolution>& found) {
  std::vector<CoulombSolution> all;
  std::size_t exact_ones = 0;
  for (const auto& [z, lambda] : exact.solutions()) {
    const double rounding = rounding_of(problem, z);
    const auto same = std::ranges::find_if(found, [&](const CoulombSolution& s) {
      return relative_distance(problem, s.z, z) <= 2 * (s.bound + s.delta + rounding);
    });
    CoulombSolution solution;
    if (same != found.end()) {
      solution = *same;
      exact_ones += same->delta == 0;
    }
    solution.z = z;
    solution.bound = rounding;
    solution.delta = 0;
    solution.isolated = true;  // there are finitely many
    solution.method += solution.method.empty() ? "rationals" : ", rationals";
    all.push_back(std::move(solution));
  }
  if (std::cmp_less(exact_ones, std::ranges::count(found, 0.0, &CoulombSolution::delta)))
    throw std::logic_error("interval Newton proved a solution that enumeration does not know");
  return all;
}

}  // namespace

SolutionCount count_solutions(const Problem& problem, double seconds) {
  SolutionCount out;
  const std::optional<ExactSolutions> exact = enumerate_planar(problem);
  SolutionSearch search{.random_starts = random_starts, .mode_choices = mode_choices, .all = true};
  search.deadline = Deadline(seconds);
  if (exact)
    for (const auto& [z, lambda] : exact->solutions()) search.near.push_back(z);
  out.solutions = coulomb_solutions(problem, search, &out.why_not);
  out.by_enumeration = exact.has_value();
  const bool continuum = std::ranges::any_of(out.solutions, &CoulombSolution::continuum);
  if (exact && exact->complete()) {
    out.solutions = confirmed(problem, *exact, out.solutions);
    out.kind = SolutionCount::Kind::all;
    out.proven = out.solutions.size();
    return out;
  }
  const auto is_exact = [](const CoulombSolution& s) { return s.delta == 0; };
  std::ranges::stable_partition(out.solutions, is_exact);
  out.proven = static_cast<std::size_t>(std::ranges::count_if(out.solutions, is_exact));
  out.kind = continuum || exact      ? SolutionCount::Kind::continuum
             : out.solutions.empty() ? SolutionCount::Kind::none_found
                                     : SolutionCount::Kind::at_least;
  return out;
}

std::string in_words(const SolutionCount& count) {
  using Kind = SolutionCount::Kind;
  const std::string enumerated = "every choice of modes was solved in rationals", proven = std::to_string(count.proven);
  if (count.kind == Kind::none_found) return "none found: " + count.why_not;
  if (count.kind == Kind::all) return (count.proven == 0 ? "none: " : proven + " and no more: ") + enumerated;
  if (count.kind == Kind::at_least)
    return count.proven == 0
               ? "none proven of these rows; those below are exact for rows that are off by delta"
               : "at least " + proven + ": those found; all are known only of six planar contacts or fewer";
  return "a continuum: " +
         (count.by_enumeration ? enumerated : "interval Newton proved that forces are free to change, and move z");
}

}  // namespace zwang
