#pragma once

#include <limits>
#include <span>
#include <vector>

#include <zwang/core/problem/solver.h>
#include <zwang/solvers/factor/dual_climb.h>
#include <zwang/solvers/factor/inverse_factor.h>
#include <zwang/solvers/factor/row_lanes.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// The climb of dual_climb.h on a small dense problem in double, laid out for the machine:
//
//   minimize 1/2 |v|^2   subject to  A v >= b   (rows of A at most 1 long)
//
// As dual_active_set.h decides, by the same tolerances, in other storage: the active rows with the inverse of their
// triangle (inverse_factor.h); A in eights of rows without the columns that none of them meets (row_lanes.h), along
// which all slacks move. This is for clear problems: the caller turns to the careful path where `smallest_accepted` is
// small, `largest_rejected` is large or a row contradicts others.
//
// Rows may be admitted at any time, and take part from the next climb on: a caller that finds rows violated by the
// optimum of those it has admitted goes on from there, and is exact at the end (joint_space_active_set.cpp).
class DenseDualActiveSet {
 public:
  static constexpr double epsilon = std::numeric_limits<double>::epsilon();
  static constexpr double rank_tolerance = tolerances::rank * epsilon,
                          violation_tolerance = tolerances::violation * epsilon;

  // No rows, and room for `room` of `freedom` entries; allocates only when the room must grow.
  void reset(Index freedom, Index room);
  // One more row a . v >= b; magnitude is what, with |v|, a violation of it is small against. The caller writes a into
  // the padded() entries it gets.
  double* admit(double b, double magnitude);
  double fixed_length = 0;  // the length of what the equality rows took away

  // The optimum of these rows alone, as far as they are clearly independent and their multipliers not negative: a warm
  // start.
  void start_from(std::span<const Index> rows);
  // Row j becomes active, however little it is violated, and of those it depends on one gives way. False where none
  // may, or its multiplier would pull.
  bool obey(Index j);

  // Up to the optimum of the rows admitted, from the present active set.
  Status climb(int& iterations, int most_iterations, const Deadline& deadline);
  // Where the refined v and multipliers of the same active set change a decision: false, and the next climb goes on.
  // As long as rows have been admitted that met no climb, v is not looked at, and multipliers alone decide.
  bool has_climbed() const { return scanned_ == rows_; }
  bool accept(const Vector& v, const Vector& u);

  Index freedom() const { return freedom_; }
  Index rows() const { return rows_; }
  Index padded() const { return padded_; }
  auto row(Index j) const { return A_.col(j); }  // padded
  double b(Index j) const { return b_[j]; }
  const std::vector<Index>& active() const { return active_; }
  bool is_active(Index j) const { return state_[at(j)] == State::active; }
  bool is_retired(Index j) const { return state_[at(j)] == State::retired; }
  const Vector& v() const { return v_; }  // padded
  const Vector& u() const { return u_; }  // first active().size()
  // The dv and dmu with dv - A'dmu = s and A dv = sigma over the active rows; all of padded().
  void solve(const Vector& s, const Vector& sigma, Vector& dv, Vector& dmu) { factor_.solve(s, sigma, dv, dmu); }
  // The length of row j outside the active ones; then how far v moves when it is obeyed and an active one gives way:
  // until that leaves, then by the violation over the share that leaving gave it (infinity: none gives way).
  double share(Index j) {
    bring_in();
    return split(j);
  }
  double detour(double share, double violation) {
    const Blocking<double> block = blocking();
    return block.row < 0 ? std::numeric_limits<double>::infinity()
                         : share * block.step + violation / (r()[block.row] * smallest_accepted);
  }
  double smallest_accepted = 1, largest_rejected = 0;

  // What dual_climb.h asks for.
  Index choose();
  double split(Index p) { return factor_.split(A_.col(p).data()); }
  bool is_dependent(double length);
  double violation(Index p) const { return std::max(0.0, -slack_[p]); }
  bool is_satisfied(Index p, double violation) const;
  Blocking<double> blocking();
  static constexpr bool contradicts(Index, double) { return true; }
  void retire(Index p);
  void move(double step, bool dependent);
  void drop(Index j);
  void append(Index p, double multiplier, double length);
  static constexpr bool is_stuck() { return false; }

 private:
  enum class State : char { resting, active, retired };

  Index size() const { return static_cast<Index>(active_.size()); }
  const double* r() const { return factor_.r().data(); }
  void set(Index j, State state);
  void bring_in();
  void scan();
  void enter(Index p, double multiplier, double length);
  void refresh();
  bool restore_dual_feasibility();

  Index freedom_ = 0, padded_ = 0, rows_ = 0, padded_rows_ = 0;
  lanes::Columns A_;
  RowLanes by_rows_;
  Index loaded_ = 0, scanned_ = 0;  // rows that by_rows_ holds; rows that met a scan
  InverseFactor factor_;            // of the active rows
  Vector b_, magnitude_, v_, u_, slack_, rest_, sigma_;
  Vector out_;  // of a row: 0 while it rests, else infinite; what is added to its slack when the worst is looked for
  Vector key_;
  std::vector<Index> active_, retired_;
  std::vector<State> state_;
};

}  // namespace zwang
