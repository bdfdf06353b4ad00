#pragma once

#include <algorithm>
#include <cmath>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/linalg/multiply_add.h>

namespace zwang {

// The first `own` steps of Cholesky's factorization of a dense symmetric matrix, in place: columns 0 .. own - 1 of the
// lower triangle become L, the rest becomes the Schur complement. Column-major, `stride` a multiple of `lanes` at least
// `size`; the strict upper triangle and the padding are scratch. False on a pivot that is not positive, and past the
// deadline.
//
// Left-looking by tiles of four columns: a tile takes all earlier columns at once, so it stays in registers, which is
// what decides at the sizes met here (6 to 200).
class DenseFront {
 public:
  // As the machine's vectors: wider ones are split in two, and the sums then no longer fit into registers.
#ifdef __AVX512F__
  static constexpr int lanes = 8;
#else
  static constexpr int lanes = 4;
#endif

  static bool factorize(double* front, int size, int own, Index stride, const Deadline& deadline) {
    for (int j = 0; j < size;) {
      const int width = std::min(4, (j < own ? own : size) - j);
      const int behind = std::min(j, own);
      if (static_cast<double>(behind) * size > long_tile && deadline.passed()) return false;
      switch (width) {
        case 4:
          subtract<4>(front, size, stride, j, behind);
          break;
        case 3:
          subtract<3>(front, size, stride, j, behind);
          break;
        case 2:
          subtract<2>(front, size, stride, j, behind);
          break;
        default:
          subtract<1>(front, size, stride, j, behind);
      }
      if (j < own && !finish(front, size, stride, j, width)) return false;
      j += width;
    }
    return true;
  }

 private:
  static constexpr double long_tile = 1e5;  // products a column: far more than a look at the clock
  using Pack = Vec<double, lanes>;

  // Columns j .. j + width - 1, from the row of the first diagonal on: minus L L' over the `behind` columns before.
  template <int width>
  static void subtract(double* front, int size, Index stride, int j, int behind) {
    if (behind == 0) return;
    int i = j / lanes * lanes;
    for (; i + lanes < size; i += 2 * lanes) tile<width, 2>(front, stride, i, j, behind);
    if (i < size) tile<width, 1>(front, stride, i, j, behind);
  }

  template <int width, int packs>
  static void tile(double* front, Index stride, int i, int j, int behind) {
    Pack sum[packs][width];
    for (int c = 0; c < width; ++c)
      for (int r = 0; r < packs; ++r) sum[r][c] = Eigen::Map<const Pack>(front + (j + c) * stride + i + r * lanes);
    const double *left = front + i, *across = front + j;
    for (int p = 0; p < behind; ++p, left += stride, across += stride) {
      Pack l[packs];
      for (int r = 0; r < packs; ++r) l[r] = Eigen::Map<const Pack>(left + r * lanes);
      for (int c = 0; c < width; ++c)
        for (int r = 0; r < packs; ++r) sum[r][c] = multiply_add(-across[c], l[r], sum[r][c]);
    }
    for (int c = 0; c < width; ++c)
      for (int r = 0; r < packs; ++r) Eigen::Map<Pack>(front + (j + c) * stride + i + r * lanes) = sum[r][c];
  }

  // The tile's own triangle, and the rows below it.
  static bool finish(double* front, int size, Index stride, int j, int width) {
    for (int c = j; c < j + width; ++c) {
      double* column = front + c * stride;
      if (!(column[c] > 0)) return false;
      const double pivot = std::sqrt(column[c]), inverse = 1 / pivot;
      column[c] = pivot;
      for (int i = c + 1; i < size; ++i) column[i] *= inverse;
      for (int next = c + 1; next < j + width; ++next) {
        double* other = front + next * stride;
        const double factor = column[next];
        for (int i = next; i < size; ++i) other[i] -= factor * column[i];
      }
    }
    return true;
  }
};

}  // namespace zwang
