#pragma once

#include <algorithm>
#include <cmath>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/linalg/multiply_add.h>

namespace zwang {

// The first `own` steps of Cholesky's factorization of a dense symmetric matrix, in place: columns 0 .. own - 1 of the
// lower triangle become L, its diagonal as reciprocals, the rest becomes the Schur complement. Column-major, `stride` a
// multiple of `lanes` at least `size`; the strict upper triangle and the padding are scratch. False on a pivot that is
// not positive, and past the deadline.
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
      by_width(width, [&]<int columns>() { subtract<columns>(front, size, stride, j, behind); });
      if (j < own && !finish(front, size, stride, j, width)) return false;
      j += width;
    }
    return true;
  }

  // Of a factor's first `own` columns: t := L^-1 t, less what that brings to the rows below, and t := L^-T t. Of front
  // and t `lanes` numbers more than they hold may be touched.
  static void solve_lower(const double* front, int size, int own, Index stride, double* t) {
    for (int c = 0; c < own; c += 4)
      by_width(own - c, [&]<int width>() {
        const double* const l = front + c * stride;
        double x[width];
        for (int k = 0; k < width; ++k) {
          x[k] = t[c + k] *= l[k * stride + c + k];
          for (int r = c + k + 1; r < c + width; ++r) t[r] -= l[k * stride + r] * x[k];
        }
        for (int r = c + width; r < size; r += lanes) {  // what is computed behind `size` nobody reads
          Eigen::Map<Pack> rest(t + r);
          Pack sum = rest;
          for (int k = 0; k < width; ++k) sum = multiply_add(-x[k], Eigen::Map<const Pack>(l + k * stride + r), sum);
          rest = sum;
        }
      });
  }
  static void solve_upper(const double* front, int size, int own, Index stride, double* t) {
    for (int c = (own - 1) / 4 * 4; c >= 0; c -= 4)
      by_width(own - c, [&]<int width>() {
        const double* const l = front + c * stride;
        Pack sums[width];
        for (Pack& sum : sums) sum.setZero();
        int whole = c + width;
        for (; whole + lanes <= size; whole += lanes)
          for (int k = 0; k < width; ++k)
            sums[k] = multiply_add(Eigen::Map<const Pack>(l + k * stride + whole), Eigen::Map<const Pack>(t + whole),
                                   sums[k]);
        for (int k = width; k-- > 0;) {
          double sum = sums[k].sum();
          for (int r = c + k + 1; r < c + width; ++r) sum += l[k * stride + r] * t[r];
          for (int r = whole; r < size; ++r) sum += l[k * stride + r] * t[r];
          t[c + k] = (t[c + k] - sum) * l[k * stride + c + k];
        }
      });
  }

 private:
  static constexpr double long_tile = 1e5;  // products a column: far more than a look at the clock
  using Pack = Vec<double, lanes>;

  // part<width>() for that many columns, four at most.
  template <class Part>
  static void by_width(int width, Part&& part) {
    if (width >= 4) return part.template operator()<4>();
    if (width == 3) return part.template operator()<3>();
    if (width == 2) return part.template operator()<2>();
    part.template operator()<1>();
  }

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
      const double inverse = 1 / std::sqrt(column[c]);
      column[c] = inverse;
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
