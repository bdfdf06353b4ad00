#pragma once

#include <functional>
#include <iterator>
#include <span>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/linalg/thin_qr.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// Non-negative least squares with some columns free:
//
//   minimize |E x - f|   subject to  x_i >= 0 except on free columns.
//
// The active-set method of Lawson & Hanson (Solving Least Squares Problems, 1974, ch. 23): one column enters the
// passive set, the least-squares problem on that set is solved, and columns whose x would turn negative leave again.
// Free columns enter first and stay. The passive columns are held as a thin QR that gains and loses columns.
//
// Rank-aware: a column whose part outside the passive ones is below `threshold` does not enter, and a column that
// rounding alone brought in (its x comes out <= 0) is barred until another one has made progress. That is the
// anti-cycling rule: every other step lowers |E x - f|, so no passive set comes back.
class LawsonHanson {
 public:
  using Columns = Eigen::Ref<const Matrix, 0, Eigen::OuterStride<>>;

  struct Limits {
    int iterations;
    Deadline deadline = Deadline();
    std::function<void()> each = {};  // called after every iteration that changes the passive set
  };

  double threshold = tolerances::dependent_column;  // relative pivot of a column

  // Solved, or the limit that was met. `warm`: columns to try as passive first. E is N x k, f is N, free is k.
  Status solve(const Columns& E, const Vector& f, std::span<const char> free, std::span<const Index> warm,
               int& iterations, const Limits& limits);

  auto x() const { return x_.head(std::ssize(state_)); }                // k
  const Vector& residual() const { return r_; }                         // f - E x
  std::span<const Index> passive() const { return passive_; }           // in the order of the QR
  std::span<const Index> dependent_free() const { return dependent_; }  // free columns that were left out

 private:
  bool enter(const Columns& E, Index column);
  void leave(std::size_t place);
  void settle(std::span<const char> free);

  ThinQr qr_;
  Vector r_;
  Vector x_, w_, length_, rotated_, trial_;  // room for the most columns there were
  std::vector<Index> passive_, dependent_;
  std::vector<char> state_;  // 0 zero, 1 passive, 2 barred
};

}  // namespace zwang
