#pragma once

#include <span>
#include <vector>

#include <zwang/core/number/double_double.h>
#include <zwang/solvers/factor/active_rows.h>
#include <zwang/solvers/factor/dual_climb.h>
#include <zwang/solvers/form/whiten.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// The active rows make Gauss' problem linear:  M d = J_A' l,  J_A d = b_A,  with d = z - z_u and b = c - J z_u.
// It is solved by iterative refinement (Bjorck 1967, BIT 7, for the augmented system): residuals come from the
// problem's own M, J, c in Real (long double or DoubleDouble), corrections from the double factors of the active unit
// rows (active_rows.h). So rounding in the whitening does not reach the answer, and z is right to its last bits as long
// as cond(G_A) eps < 1. "Ill-conditioned" is said where rounding in Real, over the smallest pivot, may have moved z
// by more than was asked for (doubt_active, doubt_others), not where a pivot is small. Then every row and multiplier is
// checked in the same precision. A violated row is added, a negative multiplier dropped, and a violated row that
// depends on the active ones either takes the place of one of them (Goldfarb & Idnani's partial step) or yields a
// Farkas certificate, refined in the same way.
//
// Tried before: trusting the least-distance solution itself loses digits as |y| grows (mass ratios of 4e9), and a rank
// threshold of 1e-12 on double rows decides near-parallel joints wrongly below 1e-10.
template <class Real>
class ExtendedPolish {
 public:
  // `active` is changed when the guess was wrong. The solution is complete, solved or infeasible; where this is false
  // it holds the last point and a message. Where an accuracy is asked for, it has a bound if the rows are clear, or
  // a motion opens all that touch.
  // passes_on: more digits follow, and what is blurred in these is left to them at once.
  bool run(const Problem& problem, const Whitened& rows, ActiveRows& active, const SolveOptions& options,
           Solution& solution, bool passes_on = false);

  // Is there a Farkas vector on `support` (rows, most important first) and the rows already active? If so the solution
  // holds it. Changes active.
  bool certify(const Problem& problem, const Whitened& rows, ActiveRows& active, std::span<const Index> support,
               Solution& solution);

  bool is_blurred() const { return is_blurred_; }  // a row is taken for a combination of others, or makes a wedge
  // Whether `unit`, multipliers of the unit rows, is a Farkas vector. If so the solution holds it.
  bool certify(const Problem& problem, const Whitened& rows, const Vector& unit, Solution& solution);

 private:
  using RealVector = VectorX<Real>;
  enum State : char { outside, inside, ignored };
  // By how much z misses a unit row, c - J z, and the sum of the terms of that difference; known at the z that `at_z`
  // numbers.
  struct Rest {
    Real violation, terms;
    int at_z = -1;
  };
  // On which side a row is violated; by how much it may be, by what rounding and z's own error hide; and by how much it
  // is beyond rounding.
  struct Doubt {
    Real sign, most;
    double over;
  };
  static constexpr double epsilon = std::numeric_limits<double>::epsilon();
  static constexpr double real_eps = static_cast<double>(std::numeric_limits<Real>::epsilon());

  void prepare(const Problem& p, const Whitened& w);
  void add_row(Index i, const Real& factor, RealVector& v) const {
    for (RowMatrix::InnerIterator it(p_->J, w_->row[at(i)]); it; ++it) v[it.col()] += Real(it.value()) * factor;
  }
  const Rest& rest(Index i);
  double correction(ActiveRows& active);
  Real unit(Index i) const { return l_[i] * Real(w_->row_norm[i]); }  // the multiplier of a unit row
  bool refine(ActiveRows& active);
  Index pulling_row(const ActiveRows& active) const;
  Index violated_row(Real& worst);
  void express(ActiveRows& active, std::span<const Index> rows);
  void express_again(ActiveRows& active, std::span<const Index> rows);
  bool farkas(ActiveRows& active, Index row, Solution& s);
  bool proves(Solution& s);
  bool exchange(ActiveRows& active, Index row);
  void remove(ActiveRows& active, Index position) {
    state_[at(active[position])] = State::outside;
    l_[active[position]] = 0;
    active.drop(position);
  }
  double inherited(const ActiveRows& active, Index column);
  double doubt_active(const ActiveRows& active);
  Doubt doubt(Index i);
  Index doubt_others(ActiveRows& active, double limit, bool passes_on);
  Index doubt_these(ActiveRows& active, std::span<const Index> rows, double limit, bool passes_on);
  Blocking<Real> blocking(const ActiveRows& active, Index column, Real sign) const;
  double detour(const ActiveRows& active, Index column, Real sign, double share, double violation) const;
  void write(Solution& s) const;
  bool wedge();
  double left_of(Index row, std::span<const Index> others, const auto& mu);
  double share(ActiveRows& active, Index row) const {  // of a row outside
    return share_[at(row)] >= 0 ? share_[at(row)] : active.share(row);
  }
  double bound(ActiveRows& active);
  double bound_beside(ActiveRows& active);
  void name_redundant(ActiveRows& active, Solution& s);
  // From z, not from z - z_u: a mechanism at rest then leaves residuals of zero from terms of zero.
  Real violation(Index i) { return rest(i).violation; }
  // What rounding can hide in a violation.
  double hidden(Index i) { return real_eps * static_cast<double>(rest(i).terms); }

  const Problem* p_ = nullptr;  // those of the last run() or certify()
  const Whitened* w_ = nullptr;
  RealVector b_;        // k: violation of the unconstrained motion, unit rows, units of 2^exponent
  RealVector z_, l_;    // n, k: the point, and the multipliers of the rows as given, times 2^-exponent
  RealVector force_;    // n
  MatrixX<Real> mu_;    // |A| x together(): dependent rows as combinations of the active ones
  Vector rest_of_;      // together(): what is left of them
  Matrix V_, T_;        // n and |A| x together(): of express()
  Vector last_;         // together(): the last columns of T_ that changed mu_
  Vector r1_, r2_;      // whitened residuals
  Vector wedge_;        // n: one of the rows that touch
  Vector certificate_;  // m: the Farkas vector under test
  std::vector<char> state_;
  std::vector<Rest> rest_;     // k
  std::vector<double> share_;  // k, of the rows outside that doubt_others() asked for it; otherwise unknown
  static constexpr double unknown = -1;
  int z_number_ = 0;
  double length_ = 0;  // |y|
  double scale_ = 0;   // max(|z_u|_M, |y|), units of 2^exponent
  double z_u_length_ = 0;
  double error_ = 0;                             // estimate of |z - z*|_M for the active set at hand
  bool is_blurred_ = false, has_faint_ = false;  // has a row an entry that is nothing to its length?
  std::vector<Index> asked_, again_, open_;      // rows outside to be expressed; of them, columns to be expressed again
  double hidden_in_z_ = 0;
  std::vector<Index> touching_;  // rows outside that are not open by more than rounding in double
  std::vector<NearRow> near_;
  double touched_ = 0;  // by how much the first of them is violated, at the most
};

}  // namespace zwang
