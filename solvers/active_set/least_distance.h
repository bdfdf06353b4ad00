#pragma once

#include <functional>
#include <span>
#include <vector>

#include <zwang/solvers/active_set/lawson_hanson.h>
#include <zwang/solvers/factor/active_rows.h>

namespace zwang {

// The shortest y that meets whitened rows, by non-negative least squares (Lawson & Hanson 1974, ch. 23, LDP) in the
// null space of the equality rows:
//
//   E = [G'; h' / sigma],  f = e_{n+1},  u = argmin |E u - f|, u >= 0;  r = f - E u
//   y = -sigma r_{1:n} / r_{n+1}   (sign: E u - f in the book),   lambda = sigma u / r_{n+1};   r = 0: infeasible.
//
// sigma is the unit of length. Its best value is |y| itself, for then |r|^2 = 1/2; where |y| / sigma is large, r is
// a small difference of large numbers. So sigma starts at the largest violation and follows |y| up, each round warm
// started with the passive set of the one before. With sigma fixed at the largest violation the method broke at mass
// ratios of 4e9; unscaled it breaks near |y| = 1e5.
class LeastDistance {
 public:
  // Both are kept until the next reset.
  void reset(const Whitened& rows, const Deadline& deadline);
  // From inequality rows of an earlier frame. Ends solved, at a limit, or infeasible where nothing is left of r, which
  // is no proof yet. `each` as in lawson_hanson.h.
  Status solve(std::span<const Index> warm, int& iterations, int most_iterations, const std::function<void()>& each);

  QrRows& equalities() { return equalities_; }
  // The inequality rows that push; where infeasible, those that contradict each other, the heaviest first.
  const std::vector<Index>& pushing() const { return pushing_; }
  // y and the multipliers of the unit rows as they stand; where infeasible, 0 and what may be the proof.
  void locate(Vector& y, Vector& unit);

 private:
  void project(Index row);
  Index columns() const { return std::ssize(column_); }

  const Whitened* w_ = nullptr;
  const Deadline* deadline_ = nullptr;
  LawsonHanson least_squares_;
  QrRows equalities_;
  Matrix E_;
  Vector f_, y_E_, h_, length_, rest_, part_;
  std::vector<Index> column_;  // column of E -> whitened row
  std::vector<char> free_;     // of the columns: none is
  std::vector<Index> warm_;    // columns
  std::vector<Index> pushing_;
  double sigma_ = 1;
  bool infeasible_ = false;
};

}  // namespace zwang
