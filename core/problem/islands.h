#pragma once

#include <cmath>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/core/problem/disjoint_sets.h>
#include <zwang/core/problem/shape_cache.h>
#include <zwang/core/problem/solver.h>
#include <zwang/core/problem/sparsity_pattern.h>

namespace zwang {

// A part of a problem that shares no unknown with the rest: two hands in the air, two towers (section 5 of the paper
// calls them clusters). Keys are kept, so warm starts and row names survive.
struct Island {
  Problem problem = {};
  std::vector<Index> columns = {};  // of the whole problem, ascending
  std::vector<Index> rows = {};     // of the whole problem, ascending
};

// Splits a problem into islands, solves them apart with any solver and joins the answers. Unknowns belong together when
// an entry of M or J couples them, stored zeros among them; islands are ordered by their first unknown. A row without
// entries goes to the first island, so that no infeasible row is lost. The storage of islands of the same shape is
// reused: splitting again allocates nothing. M and J are compressed.
class Islands {
 public:
  // Unknowns [unit k, unit k + unit) stay together: with unit = 6, bodies are never cut.
  void split(const Problem& problem, Index unit = 1);
  std::span<const Island> all() const { return {islands_.data(), count_}; }

  // Solves a problem of several islands one by one with solve(problem, options, solution), each cut out just before it
  // is solved, into the storage of the one before. The joined status is the worst of the islands'; an infeasible island
  // makes the whole infeasible, its certificate padded with zeros being one of the whole. Iterations are added up,
  // margins are the closest ones, messages name their island. The time limit is one for all, others hold per island. A
  // problem that is one island, or has an observer (iterates of problems solved apart are no iterates of the whole), is
  // solved as it is.
  template <class Solve>
  void solve_apart(Solve&& solve, Index unit, const Problem& problem, const SolveOptions& options, Solution& solution);

 private:
  // Whether there is more than one island of whole units; the list of them is reused while the sparsity stays the same.
  bool several(const Problem& problem, Index unit);
  template <class Unit>
  bool several_blocks(const Problem& problem, Unit unit);
  void list(const Problem& problem, Index unit);
  Island& next_island();
  void fill(const Problem& problem, const Island& island, Problem& part) const;
  void join(const Island& island, const Solution& part, Index rows, Solution& whole) const;

  std::vector<Island> islands_;
  std::size_t count_ = 0;
  DisjointSets blocks_;
  std::vector<Index> island_, local_;
  Index unit_ = 0;             // what several() listed the islands for, or 0
  std::vector<RowKind> kind_;  // where there are tangent rows
  SparsityPattern M_places_, J_places_;
  // Parts cut out just before they are solved: 64 shapes, as rows come and go between frames.
  ShapeCache<Problem> cut_{64};
  ShapeCache<Solution> solved_{64};
};

template <class Solve>
void Islands::solve_apart(Solve&& solve, Index unit, const Problem& problem, const SolveOptions& options,
                          Solution& solution) {
  const bool whole = options.observe || problem.size() % unit != 0 || !problem.M.isCompressed() ||
                     !problem.J.isCompressed() || !several(problem, unit);
  if (whole) return solve(problem, options, solution);
  solution.reset(problem.size(), problem.rows());
  SolveOptions rest = options;
  rest.accuracy /= std::sqrt(2);  // join() says why
  if (options.has_accuracy()) solution.error_bound = 0;
  solution.status = Status::solved;
  solution.margins.rank = 0;
  const Deadline deadline(options.time_limit);
  cut_.begin();
  solved_.begin();
  for (std::size_t k = 0; k < count_; ++k) {
    const Island& island = islands_[k];
    const auto n = std::ssize(island.columns), m = std::ssize(island.rows);
    Problem& part = cut_.of(n, m);
    Solution& own = solved_.of(n, m);
    fill(problem, island, part);
    rest.time_limit = deadline.left();
    solve(std::as_const(part), std::as_const(rest), own);
    join(island, own, problem.rows(), solution);
    if (own.message.empty()) continue;
    if (!solution.message.empty()) solution.message += "; ";
    solution.message.append("island ").append(std::to_string(k + 1)).append(": ").append(own.message);
  }
}

}  // namespace zwang
