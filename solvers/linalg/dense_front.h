#pragma once

#include <algorithm>
#include <cmath>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/linalg/multiply_add.h>
#include <zwang/solvers/linalg/packets.h>

namespace zwang {

// The first `own` steps of Cholesky's factorization of a dense symmetric matrix, in place: columns 0 .. own - 1 of the
// lower triangle become L, its diagonal as reciprocals, the others the Schur complement. The first and the other
// columns stand apart, each column-major, `stride` a multiple of `lanes` at least `size`; the strict upper triangle and
// the padding are scratch. False on a pivot that is not positive, and past the deadline.
//
// Left-looking by tiles of four columns: a tile takes all earlier columns at once, so it stays in registers. That
// decides in small fronts. In large ones each of its reads is on another page, so there the columns before a block of
// tiles are first copied to where they are read one after the other: the same products, in the same order.
class DenseFront {
 public:
  // As the machine's vectors: wider ones are split in two, and the sums then no longer fit into registers.
#ifdef __AVX512F__
  static constexpr int lanes = 8;
#else
  static constexpr int lanes = 4;
#endif

  // `scratch`: at least that many numbers.
  static Index scratch_for(int own) { return Index(own) * (block + band); }
  struct Columns {
    double *first, *others;
    int own;
    Index stride;
    double* operator[](int c) const { return c < own ? first + c * stride : others + (c - own) * stride; }
  };
  static bool factorize(const Columns& columns, int size, double* scratch, const Deadline& deadline) {
    const int own = columns.own;
    int taken = 0;  // the first columns, already taken from those up to `ready`
    for (int j = 0, ready = 0; j < size;) {
      const int behind = std::min(j, own);
      if (static_cast<double>(behind) * size > long_tile && deadline.passed()) return false;
      if (j >= ready && behind >= worth_a_copy) {
        taken = behind;
        ready = std::min(j + block, size);
        subtract_block(columns, size, j, ready, behind, scratch);
      }
      const int width = std::min({4, (j < own ? own : size) - j, j < ready ? ready - j : 4});
      by_width(width, [&]<int count>() { subtract<count>(columns, size, j, j < ready ? taken : 0, behind); });
      if (j < own && !finish(columns.first, size, columns.stride, j, width)) return false;
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
  static constexpr double long_tile = 1e5;            // products a column: far more than a look at the clock
  static constexpr int block = 32, band = 2 * lanes;  // columns and rows that a copy serves
  static constexpr int worth_a_copy = 128;            // columns before a tile
  using Pack = Vec<double, lanes>;

  // part<width>() for that many columns, four at most.
  template <class Part>
  static void by_width(int width, Part&& part) {
    if (width >= 4) return part.template operator()<4>();
    if (width == 3) return part.template operator()<3>();
    if (width == 2) return part.template operator()<2>();
    part.template operator()<1>();
  }

  // Columns j .. j + width - 1, from the row of the first diagonal on: minus L L' over the columns from `first` to
  // `behind`.
  template <int width>
  static void subtract(const Columns& columns, int size, int j, int first, int behind) {
    if (first >= behind) return;
    const Index stride = columns.stride;
    const double* const from = columns.first + first * stride;
    double* const into = columns[j];
    int i = j / lanes * lanes;
    for (; i + lanes < size; i += 2 * lanes)
      tile<width, 2>(into + i, stride, from + i, from + j, stride, stride, behind - first);
    if (i < size) tile<width, 1>(into + i, stride, from + i, from + j, stride, stride, behind - first);
  }

  // The same of columns j .. end - 1, from copies.
  static void subtract_block(const Columns& columns, int size, int j, int end, int behind, double* scratch) {
    const Index stride = columns.stride;
    double *const across = scratch, *const left = scratch + behind * Index(block);
    for (int p = 0; p < behind; ++p) std::copy_n(columns.first + p * stride + j, end - j, across + p * Index(block));
    for (int i = j / lanes * lanes; i < size; i += band) {
      const int packs = i + lanes < size ? 2 : 1;
      for (int p = 0; p < behind; ++p)
        std::copy_n(columns.first + p * stride + i, packs * lanes, left + p * Index(band));
      for (int c = j, width = 0; c < std::min(end, i + band); c += width) {
        width = std::min({4, end - c, c < columns.own ? columns.own - c : 4});
        double* const into = columns[c] + i;
        by_width(width, [&]<int count>() {
          if (packs == 2)
            tile<count, 2>(into, stride, left, across + (c - j), band, block, behind);
          else
            tile<count, 1>(into, stride, left, across + (c - j), band, block, behind);
        });
      }
    }
  }

  // Of `width` columns, minus the products of `count` columns of `left` with as many rows of `across`.
  template <int width, int packs>
  static void tile(double* into, Index stride, const double* left, const double* across, Index left_stride,
                   Index across_stride, int count) {
    constexpr int vectors = packs * lanes / packets::width;
    packets::Packet sum[vectors][width];
    for (int c = 0; c < width; ++c)
      for (int r = 0; r < vectors; ++r) sum[r][c] = packets::load(into + c * stride + r * packets::width);
    for (int p = 0; p < count; ++p, left += left_stride, across += across_stride) {
      packets::Packet l[vectors];
      for (int r = 0; r < vectors; ++r) l[r] = packets::negative(packets::load(left + r * packets::width));
      for (int c = 0; c < width; ++c) {
        const packets::Packet x = packets::all_of(across + c);
        for (int r = 0; r < vectors; ++r) sum[r][c] = packets::multiply_add(x, l[r], sum[r][c]);
      }
    }
    for (int c = 0; c < width; ++c)
      for (int r = 0; r < vectors; ++r) packets::store(into + c * stride + r * packets::width, sum[r][c]);
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
