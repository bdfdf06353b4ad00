#pragma once

#include <limits>
#include <span>
#include <vector>

#include "core/solver.h"
#include "solvers/stop.h"

namespace zwang {

// The climb of goldfarb_idnani.h on a small dense problem in double, laid out for the machine:
//
//   minimize 1/2 |v|^2   subject to  A v >= b   (rows of A at most 1 long)
//
// The same decisions and tolerances, other storage: columns padded to eight lanes; next to Q the inverse T = R^-1
// instead of R, because an entering row then needs products only (r = T Q'a, and T's new column is -r / length), no
// back substitution whose steps wait for each other; A also by rows, so that the scan over all slacks runs along
// lanes. An inverse loses digits as R's condition squared at worst: this is for clear problems, and the caller turns to
// the careful path where `smallest_accepted` is small, `largest_rejected` is large or a row contradicts others.
//
// Tried: R with back substitution (0.25 us a step more at 20 active rows); a second orthogonalization always (it is
// needed only where the first one shortens the column, Kahan's criterion).
class LeastDistance {
 public:
  static constexpr Index lanes = 8;
  static constexpr double epsilon = std::numeric_limits<double>::epsilon();
  static constexpr double rank_tolerance = 64 * epsilon, violation_tolerance = 8 * epsilon;  // as in goldfarb_idnani.h
  using Columns = Mat<double, Eigen::Dynamic, Eigen::Dynamic>;

  // Room for `rows` columns of `freedom` entries, all zero; allocates only when the room must grow.
  void reset(Index freedom, Index rows);
  auto row(Index j) { return A_.col(j); }  // padded; the caller fills it, b and magnitude
  auto row(Index j) const { return A_.col(j); }
  Vector b, magnitude;      // rows
  double fixed_length = 0;  // the length of what the equality rows took away

  // The optimum of these rows alone, as far as they are clearly independent and their multipliers not negative: a warm
  // start. Other rows need not be filled yet.
  void start_from(std::span<const Index> rows);
  // All rows are there: climb() may follow.
  void complete();

  enum class End { optimal, contradiction, iteration_limit, time_limit };
  // Up to the optimum of the rows, from the present active set.
  End climb(int& iterations, int most_iterations, const Deadline& deadline);
  // Where the refined v and multipliers of the same active set change a decision: false, and the next climb goes on.
  // Before complete() only multipliers decide.
  bool accept(const Vector& v, const Vector& u);

  Index freedom() const { return freedom_; }
  Index rows() const { return rows_; }
  Index padded() const { return padded_; }
  const std::vector<Index>& active() const { return active_; }
  bool is_active(Index j) const { return state_[static_cast<std::size_t>(j)] == State::active; }
  bool is_retired(Index j) const { return state_[static_cast<std::size_t>(j)] == State::retired; }
  const Vector& v() const { return v_; }      // padded
  const Vector& u() const { return u_; }      // first active().size()
  double share(Index j) { return split(j); }  // of row j: the length of its part outside the active ones
  double smallest_accepted = 1, largest_rejected = 0;

  // For the refinement: x := R^-T x, x := R^-1 x, and Q'w, Q x, over the active rows.
  void solve_transposed(Vector& x) const;
  void solve(Vector& x) const;
  void project(const Vector& w, Vector& x) const;
  void combine(const Vector& x, Vector& w) const;

 private:
  enum class State : char { resting, active, retired };

  Index size() const { return static_cast<Index>(active_.size()); }
  void carry();
  double split(Index p);
  void append(Index p, double multiplier);
  void drop(Index j);
  void refresh();
  bool restore_dual_feasibility();
  void scan();
  void move_along();
  Index most_violated() const;

  Index freedom_ = 0, padded_ = 0, rows_ = 0, padded_rows_ = 0;
  Columns A_, At_, Q_, T_, AQ_;
  bool complete_ = false, carried_ = true;  // A' is there; A Q is
  Vector v_, u_, r_, d_, remainder_, slack_, along_, rest_;
  double length_ = 0;
  std::vector<Index> active_;
  std::vector<State> state_;
};

}  // namespace zwang
