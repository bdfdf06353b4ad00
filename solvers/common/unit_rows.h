#pragma once

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/linalg/block_cholesky.h>
#include <zwang/solvers/linalg/sparse_cholesky.h>

namespace zwang {

// The rows of a problem as solvers/common/whiten.h scales them, sparse and over the columns of M itself: with d = z -
// z_u in units of 2^exponent,
//
//   minimize 1/2 d'Md   subject to  g_i d = h_i  or  >= h_i,   g_i = J_i / norm_i,  norm_i = |J_i|_(M^-1),
//
// and the worst violation of z_u in [1/2, 1). Nothing here is dense: 7744 rows of a wall of 1000 bricks hold 41,000
// entries, where their whitened columns would hold 46 million. h comes from the stored doubles in long double. A second
// build of the same shape allocates nothing.
struct UnitRows {
  using Real = long double;

  SparseRows g;                // k unit rows, columns of M
  VectorX<Real> h;             // k
  Vector norm;                 // k
  Vector magnitude;            // k: |c_i| of the unit row + |z_u|_M
  std::vector<Index> row;      // k: the problem's row
  std::vector<char> equality;  // k
  std::vector<Index> idle;     // the problem's zero rows that hold trivially
  Index conflict = -1;         // a zero row that cannot hold, or -1
  int exponent = 0;
  double free_length = 0;         // |z_u|_M
  SparseCholesky<double> factor;  // of M

  Index rows() const { return static_cast<Index>(row.size()); }
  bool build(const Problem& problem, const Deadline& deadline = Deadline());  // false when M is not positive definite

  // Multipliers of the problem's rows from those of the unit rows, and back.
  double multiplier(Index i, Real unit) const;
  double unit_multiplier(Index i, double lambda) const;

 private:
  double length(std::size_t begin);  // |g|_(M^-1) of the entries from `begin` on

  Vector scratch_;
  std::vector<int> entries_, touched_;
  std::vector<char> alone_;  // columns of M with nothing off the diagonal
  Vector diagonal_;
};

}  // namespace zwang
