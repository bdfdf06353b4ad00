#pragma once

#include <vector>

#include <zwang/solvers/factor/active_rows.h>
#include <zwang/solvers/linalg/tolerances.h>
#include <zwang/solvers/session.h>

namespace zwang {

// The active rows by sparse Cholesky on the Delassus matrix S_A = G_A G_A' of the unit rows. Its condition number is
// the square of that of G_A, so every solution is refined with residuals in the primal space, v - G_A' t, where no
// square has been taken, and a row of which little is outside the others is left to orthogonal factors unless it is an
// exact combination.
class CholeskyRows : public ActiveRows {
 public:
  CholeskyRows() : ActiveRows(tolerances::gram_share, tolerances::gram_dependent) {}

  void reset(const Whitened& w, const Deadline& deadline) override;
  bool refactor() override;
  bool healthy() const override { return healthy_; }
  double append(Index row) override;
  double share(Index row) override;
  void drop(Index position) override;
  double smallest_pivot() const override;
  double contraction() const override { return rounding_over(smallest_pivot() * smallest_pivot()); }
  void combine(Parts V, Parts T) override {
    for (Index c = 0; c < V.cols(); ++c) project(V.col(c), T.col(c), 2);
  }
  void correct(Vector& r1, Part r2) override;

 private:
  struct Cholmod;

  bool factor_row(Index row);
  void project(Part v, Part t, int passes);

  Session<Cholmod> factor_;  // opened by reset()
  std::vector<char> inside_;
  std::vector<int> index_;
  std::vector<double> value_;
  Vector x_, rest_, part_;
  bool healthy_ = true;
};

}  // namespace zwang
