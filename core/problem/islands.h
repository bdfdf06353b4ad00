#pragma once

#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <zwang/core/problem/deadline.h>
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
// a non-zero of M or J couples them (stored zeros do not); islands are ordered by their first unknown. A row without
// non-zeros goes to the first island, so that no infeasible row is lost. The storage of islands of the same shape is
// reused: splitting again allocates nothing.
class Islands {
 public:
  // Unknowns [unit k, unit k + unit) stay together: with unit = 6, bodies are never cut.
  void split(const Problem& problem, Index unit = 1);
  std::span<const Island> all() const { return {islands_.data(), count_}; }

  // Splits and solves. The joined status is the worst of the islands'; an infeasible island makes the whole infeasible,
  // its certificate padded with zeros being one of the whole. Iterations are added up, margins are the closest ones,
  // messages name their island. The time limit is one for all, others hold per island; the observer is not called
  // (iterates of problems solved apart are no iterates of the whole). A problem that is one island goes to the solver
  // as it is.
  void solve(AnySolver& solver, const Problem& problem, const SolveOptions& options, Solution& solution);
  // The same over islands that were split before, with solve(problem, options, solution) for each.
  template <class Solve>
  void solve_each(Solve&& solve, const Problem& problem, const SolveOptions& options, Solution& solution);
  // Solves a problem of several islands one by one, each cut out just before it is solved, into the storage of the one
  // before. A problem of one island, or with an observer, is solved as a whole. Stored zeros couple here too.
  template <class Solve>
  void solve_apart(Solve&& solve, Index unit, const Problem& problem, const SolveOptions& options, Solution& solution) {
    const bool whole = options.observe || problem.size() % unit != 0 || !problem.M.isCompressed() ||
                       !problem.J.isCompressed() || !several(problem, unit);
    if (whole) return solve(problem, options, solution);
    cut_.begin();
    const auto cut = [&](const Island& island) -> const Problem& {
      Problem& part = cut_.of(std::ssize(island.columns), std::ssize(island.rows));
      fill(problem, island, true, part);
      return part;
    };
    solve_parts(cut, solve, problem, options, solution);
  }

 private:
  Index root(Index unknown);
  Index couple(Index a, Index b);
  // Whether there is more than one island of whole units; the list of them is reused while the sparsity stays the same.
  bool several(const Problem& problem, Index unit);
  template <class Unit>
  bool several_blocks(const Problem& problem, Unit unit);
  void find(const Problem& problem, Index unit);
  void list(const Problem& problem, Index unit);
  template <class Part, class Solve>
  void solve_parts(Part&& part, Solve&& solve, const Problem& problem, const SolveOptions& options, Solution& solution);
  Island& next_island();
  void fill(const Problem& problem, const Island& island, bool closed, Problem& part) const;
  void join(const Island& island, const Solution& part, Index rows, Solution& whole) const;

  std::vector<Island> islands_;
  std::size_t count_ = 0;
  std::vector<Index> parent_, island_, local_;
  Index unit_ = 0;  // what several() listed the islands for, or 0
  SparsityPattern M_places_, J_places_;
  // Parts cut out just before they are solved: 64 shapes, as rows come and go between frames.
  ShapeCache<Problem> cut_{64};
  ShapeCache<Solution> solved_{64};
};

template <class Solve>
void Islands::solve_each(Solve&& solve, const Problem& problem, const SolveOptions& options, Solution& solution) {
  const auto split = [](const Island& island) -> const Problem& { return island.problem; };
  solve_parts(split, solve, problem, options, solution);
}

template <class Part, class Solve>
void Islands::solve_parts(Part&& part, Solve&& solve, const Problem& problem, const SolveOptions& options,
                          Solution& solution) {
  solution.reset(problem.size(), problem.rows());
  SolveOptions quiet = options;
  quiet.observe = nullptr;
  solution.status = Status::solved;
  solution.margins.rank = 0;
  const Deadline deadline(options.time_limit);
  solved_.begin();
  for (std::size_t k = 0; k < count_; ++k) {
    const Island& island = islands_[k];
    Solution& own = solved_.of(std::ssize(island.columns), std::ssize(island.rows));
    quiet.time_limit = deadline.left();
    solve(part(island), std::as_const(quiet), own);
    join(island, own, problem.rows(), solution);
    if (own.message.empty()) continue;
    if (!solution.message.empty()) solution.message += "; ";
    solution.message.append("island ").append(std::to_string(k + 1)).append(": ").append(own.message);
  }
}

}  // namespace zwang
