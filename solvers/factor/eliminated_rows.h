#pragma once

#include <span>
#include <vector>

#include <zwang/solvers/factor/active_rows.h>
#include <zwang/solvers/form/equality_elimination.h>

namespace zwang {

// The active rows where the equality rows leave first: y = y_E + N v (equality_elimination.h) turns the inequality rows
// into A v >= b,
//
//   A = N'G_I,   b = h_I - G_I y_E
//
// in n - rank unknowns, and a thin QR of columns of A holds the active ones. The accepted equality rows are active from
// reset() on, in the order of their factor, and stay.
class EliminatedRows : public QrRows {
 public:
  bool sparse = false;  // a sparse QR of the equality rows where it pays

  void reset(const Whitened& w, const Deadline& deadline) override;
  double append(Index row) override;
  double share(Index row) override;
  double smallest_pivot() const override;
  void combine(Parts V, Parts T) override;
  Index together() const override { return elimination_.together(); }
  void correct(Vector& r1, Part r2) override;

  Index rank() const { return elimination_.rank(); }                        // of the equality rows
  Index freedom() const { return elimination_.freedom(); }                  // unknowns of the reduced problem
  std::span<const Index> rejected() const { return rejected_; }             // equality rows that depend on the others
  const std::vector<Index>& inequalities() const { return inequalities_; }  // row of each column of A
  const Matrix& A() const { return A_; }
  const Vector& b() const { return b_; }
  double b_of(Index row) const { return w_->h[row] - w_->dot(row, y_E_); }  // h - g y_E of any row
  double y_E_norm() const { return y_E_norm_; }

  // The factor of the active columns of A. accept(): the column that it split last joins, column j of A.
  ThinQr& qr() { return qr_; }
  void accept(Index j) {
    qr_.append();
    rows_.push_back(inequalities_[at(j)]);
  }
  void lift(const Vector& v, Vector& y);  // y = y_E + N v
  // The combinations G_E' T of the accepted equality rows nearest to Y (padded n, changed).
  void balance(Parts Y, Parts T) const;
  Index padded_size() const { return elimination_.padded_size(); }

 private:
  const Vector& reduced(Index row);

  EqualityElimination elimination_;
  std::vector<Index> equalities_, inequalities_, rejected_;
  std::vector<Index> column_;  // of a row in A, or -1
  Matrix A_;                   // freedom x inequality rows
  Vector b_, y_E_;             // of the inequality rows; padded n
  Vector w_E_;                 // rank: the range part of y_E
  Vector x_, step_, range_;    // padded n; n; rank
  Vector v_;                   // freedom
  Matrix X_, V_;               // padded n and freedom x together()
  double y_E_norm_ = 0;
};

}  // namespace zwang
