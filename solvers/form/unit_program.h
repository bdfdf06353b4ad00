#pragma once

#include <zwang/solvers/form/warm_rows.h>

namespace zwang {

// The whitened problem (whiten.h) as iterative methods and adapters want it: every length is divided by sigma, a power
// of two near max(|z_u|_M, worst violation), so that an absolute tolerance means what measure.h means by it and |y|^2
// cannot overflow:
//
//   minimize 1/2 |y|^2   subject to  G y = h or >= h;   at the solution y = G' lambda, lambda_I >= 0.
//
// Rebuilding it for a problem of the same shape allocates nothing.
class UnitProgram : public Whitened {
 public:
  // Resets the solution. False when the answer is already known, and then written: M not positive definite, a zero
  // row that cannot hold, or no rows at all.
  bool build(const Problem& problem, const SolveOptions& options, Solution& solution);

  std::vector<Index> rows_of(bool equalities) const;  // the equality rows, or the inequality rows
  Rows some(const std::vector<Index>& rows) const;    // of G
  bool is_equality(Index i) const { return equality[at(i)] != 0; }

  void motion(const Vector& lambda, Vector& y) const;  // y = G' lambda
  void slack(const Vector& y, Vector& slack) const;    // G y - h
  void project(Vector& lambda) const;                  // inequality rows: max(0, lambda)
  double scale(const Vector& y) const;                 // max(|z_u|_M, |z|_M), in units of sigma
  double reach() const;                                // max(|z_u|_M, worst |h|), likewise
  // Worst |slack_i| (equality) or |min(lambda_i, slack_i)| (inequality) over scale(y): violation, sign and
  // complementarity in one, without the square root that lambda_i slack_i hides.
  double natural_residual(const Vector& y, const Vector& lambda) const;
  // The larger of that and |y - G'lambda|, before a rival's answer is claimed solved. It is not the referee:
  // core/referee/measure.h trusts nothing from here.
  double kkt_residual(const Vector& y, const Vector& lambda) const;

  // Multipliers of an earlier frame on the unit rows, matched by key; zero where there is none.
  void warm_multipliers(const Problem& problem, const WarmStart* warm, Vector& lambda);
  // z and, unless it is empty, lambda of the problem.
  void write(const Problem& problem, const Vector& y, const Vector& lambda, Solution& solution) const;
  // A vector over the unit rows as a Farkas vector over the problem's rows.
  void write_certificate(const Problem& problem, const Vector& u, Solution& solution) const;

 private:
  WarmRows warm_rows_;
  double sigma_ = 1;
};

}  // namespace zwang
