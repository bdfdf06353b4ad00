#pragma once

#include <span>
#include <vector>

#include <zwang/solvers/factor/dual_climb.h>
#include <zwang/solvers/factor/eliminated_rows.h>

namespace zwang {

// The rows of dual_climb.h by orthogonal updates, in what the equality rows leave free (eliminated_rows.h): every rank
// is decided row by row, against rounding in the rows themselves.
class CarefulClimb {
 public:
  // Both are kept until the next reset; `sparse` as in EliminatedRows.
  void reset(const Whitened& rows, bool sparse, const Deadline& deadline);
  EliminatedRows& active() { return active_; }
  // Takes in the rows of an earlier frame that are clearly independent, and drops again what does not fit now: a bad
  // guess costs time only.
  void warm_start(std::span<const Index> rows);

  // The point of the climb, as the factors give it: y() and multipliers of the unit rows.
  void locate();
  // unit() = sign (row - its combination of the active rows): `row` an equality row that depends on the others, before
  // the climb. The climb leaves that of a row that contradicts the active ones.
  void express(Index row, double sign);
  const Vector& y() const { return y_; }
  const Vector& unit() const { return unit_; }

  // What dual_climb.h asks for, of the columns of A.
  Index choose();
  double split(Index j);
  static bool is_dependent(double length) { return !(length > tolerances::rank * epsilon); }
  double violation(Index j) const { return std::max(0.0, active_.b()[j] - active_.A().col(j).dot(v_)); }
  bool is_satisfied(Index j, double violation) const;
  Blocking<double> blocking() const;
  bool contradicts(Index j, double);
  void retire(Index j) { state_[at(j)] = retired; }
  void move(double step, bool dependent);
  void drop(Index position);
  void append(Index j, double multiplier, double);
  static constexpr bool is_stuck() { return false; }

 private:
  enum State : char { resting, held, retired };
  static constexpr double epsilon = std::numeric_limits<double>::epsilon();

  void restore_dual_feasibility();
  void combine(const Vector& part, double sign);
  double magnitude(Index j) const { return w_->magnitude[active_.inequalities()[at(j)]]; }
  Index size() { return active_.qr().size(); }

  const Whitened* w_ = nullptr;
  EliminatedRows active_;
  std::vector<Index> place_;    // column of A of each active inequality row, in the factor's order
  std::vector<char> state_;     // of the columns of A
  Vector v_, u_, r_;            // freedom: (v, u), and the entering row's parts along the active ones
  Vector slack_;                // of the columns of A
  Vector y_, rest_, equality_;  // n; padded n; accepted equality rows
  Vector unit_;                 // of the unit rows
};

}  // namespace zwang
