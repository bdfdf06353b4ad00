#pragma once

#include <array>
#include <vector>

#include <zwang/core/problem/problem.h>
#include <zwang/solvers/linalg/line_matrix.h>
#include <zwang/solvers/linalg/multiply_add.h>

namespace zwang {

// Gauss' problem in whitened coordinates, body by body: M = L L' in 6 x 6 blocks, y_b = 2^-exponent L_b' (z - z_u)_b,
//
//   minimize 1/2 |y|^2   subject to  g_i . y = h_i  or  >= h_i,   unit rows that touch one or two bodies.
//
// The same unit rows as BasicWhitened (whiten.h), kept as two parts of six entries instead of a dense column, each in
// eight lanes of which the last two are zero. It holds for the problems that jointed bodies make, and build() says no
// to everything else: another size than 6 a body, M coupling two bodies, rows over three, empty rows, numbers so large
// or small that whiten.h's scaling by powers of two would be needed. A second build of the same shape allocates
// nothing.
struct BodyRows {
  static constexpr Index lanes = 8;
  using Lanes = Vec<double, lanes>;
  using Block = Mat<double, lanes, 6>;
  using Motion = LineMatrix<lanes>;  // lanes x bodies
  struct alignas(64) Mass {
    Block M, L_inverse, L_inverse_t;
  };

  std::vector<Index> row;                // k: the problem's row
  std::vector<char> equality;            // k
  std::vector<std::array<int, 2>> body;  // k: ascending; the second is -1 for a row on one body
  std::vector<Index> place;              // k: column of the row's first part below; its second follows
  LineMatrix<lanes> G;                   // lanes x parts
  LineMatrix<lanes> J;                   // likewise, the problem's own entries
  Vector c;                              // k, the problem's own
  Vector h;                              // k, in units of 2^exponent
  Vector row_norm;                       // k: the M-norm of the problem's row, divided out
  Vector magnitude;        // k: |c_i| of the unit row + |z_u|_M: what, with |y|, a violation is small against
  std::vector<Mass> mass;  // a body
  Motion z_u;
  Motion free;  // L'z_u, in units of 2^exponent
  double free_norm = 0;
  int exponent = 0;

  // In two sums that do not wait for each other.
  static Lanes times(const Block& A, const Eigen::Ref<const Lanes>& x) {
    Lanes even = A.col(0) * x[0], odd = A.col(1) * x[1];
    for (Index k = 2; k < 6; k += 2) {
      even = multiply_add(x[k], A.col(k), even);
      odd = multiply_add(x[k + 1], A.col(k + 1), odd);
    }
    return even + odd;
  }
  Index bodies() const { return static_cast<Index>(mass.size()); }
  Index rows() const { return static_cast<Index>(row.size()); }
  auto part(Index i, int side) { return G.col(place[at(i)] + side); }
  auto part(Index i, int side) const { return G.col(place[at(i)] + side); }
  auto own_part(Index i, int side) const { return J.col(place[at(i)] + side); }
  double dot(Index i, const Motion& y) const { return dot(i, y, G); }
  double dot(Index i, const Motion& y, const Motion& parts) const {  // of G or J
    const auto own = body[at(i)];
    double sum = parts.col(place[at(i)]).dot(y.col(own[0]));
    if (own[1] >= 0) sum += parts.col(place[at(i)] + 1).dot(y.col(own[1]));
    return sum;
  }
  // y += scale g_i.
  void add(Index i, double scale, Motion& y) const {
    const auto own = body[at(i)];
    y.col(own[0]) += scale * part(i, 0);
    if (own[1] >= 0) y.col(own[1]) += scale * part(i, 1);
  }

  double tied() const;  // as SparseCholesky's: the largest M_jj (M^-1)_jj
  // False where the problem is of another kind; nothing can be read then.
  bool build(const Problem& problem);

 private:
  bool load_mass(const Problem& problem, Index b, bool& apart);
  template <Index size>
  bool factorize(Index base, Index first);
  bool factorize(const Problem& problem);
  bool load_rows(const Problem& problem);
  void whiten_rows(const Problem& problem);
  bool make_unit_rows();

  Vector reciprocal_;  // k: of row_norm
};

}  // namespace zwang
