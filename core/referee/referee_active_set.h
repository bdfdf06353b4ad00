#pragma once

#include <vector>

#include <zwang/core/referee/orthogonal_rows.h>
#include <zwang/core/referee/scaled_problem.h>

namespace zwang {

// The referee solves the problem itself, from the rows that a solver's answer suggests hold.
//
//   minimize 1/2 |y|^2   subject to  g_i . y = h_i  or  >= h_i       (y = Q (z - z_u), unit rows)
//
// The guessed rows are cut down to independent ones with nonnegative multipliers (Caratheodory), and the dual
// active-set steps of Goldfarb & Idnani (1983) put right what the guess got wrong. After each change y = G_A' mu,
// G_A y = h_A is solved anew: directions from the orthogonal factors in FactorReal, residuals in double-double, so
// every decision (is a row violated, is a multiplier negative) is taken at about 1e-30 and not at 1e-16. A right
// guess costs one factorization and three refinements. It shares no code with the solvers under test, and nothing of
// it is believed: bounds.cpp proves what it found.
class RefereeActiveSet {
 public:
  enum class Outcome { optimal, infeasible, gave_up };

  // gave_up when the factorizations would take more than `work_limit` multiplications.
  explicit RefereeActiveSet(const ScaledProblem& scaled, double work_limit = referee::dense_products)
      : scaled_(scaled), work_left_(work_limit) {}

  // guess_lambda may be null: rows touched to 1e-6 are then guessed to hold.
  Outcome solve(const ExtendedVector& guess_d, const ExtendedVector* guess_lambda);

  ExtendedVector d, lambda;  // when optimal; lambda only on `basis`
  std::vector<Index> basis;  // independent rows that hold, equality rows first
  Index equality_rank = 0;   // how many of `basis` are equality rows
  OrthogonalRows rows;       // factors of `basis`
  Vector farkas;             // when infeasible: m, u of the scaled problem

 private:
  using Real = OrthogonalRows::Real;
  using Column = OrthogonalRows::Column;

  void guess(const ExtendedVector& guess_d, const ExtendedVector* guess_lambda);
  void take(Index row, Real weight);
  void hold(Index row, Real weight, const OrthogonalRows::Split& s);
  void drop(Index place);
  bool refine();
  bool drop_negative();
  Index worst_violated() const;
  Outcome add(Index row);
  OrthogonalRows::Split split(Index row);
  // The place of the inequality row whose multiplier first reaches zero along mu - t alpha, and t.
  std::pair<Index, Real> first_blocked(const Column& alpha) const;
  void store_farkas(Index row, Real sign, const Column& alpha);
  bool held(Index row) const { return place_[at(row)]; }

  const ScaledProblem& scaled_;
  double work_left_;
  std::vector<Real> mu_;     // multipliers of `basis`, on unit rows
  Real mu_error_ = 0;        // the correction that refine() left undone
  std::vector<char> place_;  // row is in `basis`
};

}  // namespace zwang
