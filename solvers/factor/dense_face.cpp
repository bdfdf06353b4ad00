#include <zwang/solvers/factor/dense_face.h>

#include <algorithm>
#include <cmath>

#include <zwang/solvers/linalg/lanes.h>

namespace zwang {
namespace {

using lanes::Lanes;
constexpr Index width = lanes::width, panel = 8, tile = 4;

// C(i .. i + 8, 0 .. 4) += sign sum over k of A_k(i .. i + 8) B_k(0 .. 4).
template <int sign>
void add_tile(const double* A, Index A_stride, const double* B, Index B_stride, Index count, double* C,
              Index C_stride) {
  Lanes c0 = lanes::at(C, 0), c1 = lanes::at(C + C_stride, 0), c2 = lanes::at(C + 2 * C_stride, 0),
        c3 = lanes::at(C + 3 * C_stride, 0);
  for (Index k = 0; k < count; ++k, A += A_stride, B += B_stride) {
    const Lanes a = lanes::at(A, 0);
    c0 = multiply_add(sign * B[0], a, c0);
    c1 = multiply_add(sign * B[1], a, c1);
    c2 = multiply_add(sign * B[2], a, c2);
    c3 = multiply_add(sign * B[3], a, c3);
  }
  lanes::at(C, 0) = c0;
  lanes::at(C + C_stride, 0) = c1;
  lanes::at(C + 2 * C_stride, 0) = c2;
  lanes::at(C + 3 * C_stride, 0) = c3;
}

}  // namespace

void DenseFace::reset(Index size, Index cones, Index rays) {
  size_ = size;
  padded_ = lanes::round_up(std::max<Index>(size, 1));
  cones_ = cones;
  rays_ = rays;
  rows_ = 3 * cones + rays;
  if (G_.rows() != padded_ || G_.cols() < rows_) {
    G_.resize(padded_, rows_);
    A_.resize(padded_, rows_);
    DG_.resize(padded_, rows_);
  }
  G_.leftCols(rows_).setZero();
  if (H_.rows() != padded_) {
    H_.setZero(padded_, padded_);
    across_.setZero(padded_, panel);
    reciprocal_.setZero(padded_);
    exchange_.resize(at(padded_));
  }
}

void DenseFace::slack(const Vector& v, Vector& s) const {
  lanes::multiply_transposed(G_, rows_, v.data(), s.data(), padded_);
}

void DenseFace::force(const Vector& l, Vector& f) const {
  f.setZero();
  lanes::accumulate(G_, rows_, l.data(), f.data(), 0, padded_);
}

// Rows without weight, those of open contacts, add nothing: the others are copied side by side.
Index DenseFace::pack(const std::vector<double>& D, const Vector& ray_weight) {
  Index count = 0;
  for (Index k = 0; k < cones_; ++k) {
    const double* d = D.data() + 9 * k;
    if (std::all_of(d, d + 9, [](double x) { return x == 0; })) continue;
    const double *x = row(3 * k), *y = row(3 * k + 1), *z = row(3 * k + 2);
    for (Index q = 0; q < 3; ++q, ++count) {
      double* out = DG_.col(count).data();
      for (Index i = 0; i < padded_; i += width)
        lanes::at(out, i) = multiply_add(
            d[q + 6], lanes::at(z, i), multiply_add(d[q + 3], lanes::at(y, i), (d[q] * lanes::at(x, i)).eval()).eval());
      A_.col(count) = G_.col(3 * k + q);
    }
  }
  for (Index r = 3 * cones_; r < rows_; ++r) {
    if (ray_weight[r - 3 * cones_] == 0) continue;
    DG_.col(count) = ray_weight[r - 3 * cones_] * G_.col(r);
    A_.col(count++) = G_.col(r);
  }
  return count;
}

bool DenseFace::factorize(const std::vector<double>& D, const Vector& ray_weight, bool symmetric) {
  symmetric_ = symmetric;
  const Index rows = pack(D, ray_weight);
  H_.setIdentity();
  constexpr Index block = 96;  // rows whose tiles stay in the first cache
  for (Index first = 0; first < rows; first += block) {
    const Index count = std::min(block, rows - first);
    for (Index j = 0; j < size_; j += tile)
      for (Index i = symmetric ? j / width * width : 0; i < padded_; i += width)
        add_tile<1>(&A_(i, first), padded_, &DG_(j, first), padded_, count, &H_(i, j), padded_);
  }
  return symmetric ? cholesky() : lu();
}

// H(:, end ..) -= L(:, begin .. end) U(begin .. end, end ..); U's rows are copied out side by side.
void DenseFace::update(Index begin, Index end, bool lower) {
  const Index count = end - begin;
  for (Index k = 0; k < count; ++k)
    for (Index j = end; j < padded_; ++j) across_(j, k) = lower ? H_(j, begin + k) : H_(begin + k, j);
  for (Index j = end; j < size_; j += tile)
    for (Index i = (lower ? j : end) / width * width; i < padded_; i += width)
      add_tile<-1>(&H_(i, begin), padded_, &across_(j, 0), padded_, count, &H_(i, j), padded_);
}

bool DenseFace::cholesky() {
  for (Index begin = 0; begin < size_; begin += panel) {
    const Index end = std::min(begin + panel, size_);
    for (Index j = begin; j < end; ++j) {
      double* own = H_.col(j).data();
      if (!(own[j] > 0) || !std::isfinite(own[j])) return false;
      reciprocal_[j] = 1 / std::sqrt(own[j]);
      for (Index i = j; i < padded_; ++i) own[i] *= reciprocal_[j];
      for (Index k = j + 1; k < end; ++k) {
        const double factor = own[k];
        double* other = H_.col(k).data();
        for (Index i = begin; i < padded_; i += width)
          lanes::at(other, i) = multiply_add(-factor, lanes::at(own, i), lanes::at(other, i));
      }
    }
    if (end < size_) update(begin, end, true);
  }
  return true;
}

bool DenseFace::lu() {
  for (Index begin = 0; begin < size_; begin += panel) {
    const Index end = std::min(begin + panel, size_);
    for (Index j = begin; j < end; ++j) {
      double* own = H_.col(j).data();
      Index pivot = j;
      for (Index i = j + 1; i < size_; ++i)
        if (std::abs(own[i]) > std::abs(own[pivot])) pivot = i;
      if (!(std::abs(own[pivot]) > 0) || !std::isfinite(own[pivot])) return false;
      exchange_[at(j)] = pivot;
      if (pivot != j)
        for (Index k = 0; k < size_; ++k) std::swap(H_(j, k), H_(pivot, k));
      reciprocal_[j] = 1 / own[j];
      for (Index i = j + 1; i < size_; ++i) own[i] *= reciprocal_[j];
      for (Index k = j + 1; k < end; ++k) {
        double* other = H_.col(k).data();
        const double factor = other[j];
        for (Index i = j + 1; i < size_; ++i) other[i] = multiply_add(-factor, own[i], other[i]);
      }
    }
    if (end == size_) break;
    for (Index k = end; k < size_; ++k) {
      double* other = H_.col(k).data();
      for (Index j = begin; j < end; ++j)
        for (Index i = j + 1; i < end; ++i) other[i] = multiply_add(-other[j], H_(i, j), other[i]);
    }
    // Panels begin and end on whole vectors, so no row of U is touched.
    update(begin, end, false);
  }
  return true;
}

void DenseFace::solve(Vector& x) {
  if (symmetric_) {
    for (Index j = 0; j < size_; ++j) {
      const double* own = H_.col(j).data();
      x[j] *= reciprocal_[j];
      for (Index i = j + 1; i < size_; ++i) x[i] = multiply_add(-x[j], own[i], x[i]);
    }
    for (Index j = size_ - 1; j >= 0; --j)
      x[j] = (x[j] - H_.col(j).segment(j + 1, size_ - j - 1).dot(x.segment(j + 1, size_ - j - 1))) * reciprocal_[j];
  } else {
    for (Index j = 0; j < size_; ++j) {
      if (const Index pivot = exchange_[at(j)]; pivot != j) std::swap(x[j], x[pivot]);
    }
    for (Index j = 0; j < size_; ++j) {
      const double* own = H_.col(j).data();
      for (Index i = j + 1; i < size_; ++i) x[i] = multiply_add(-x[j], own[i], x[i]);
    }
    for (Index j = size_ - 1; j >= 0; --j) {
      const double* own = H_.col(j).data();
      x[j] *= reciprocal_[j];
      for (Index i = 0; i < j; ++i) x[i] = multiply_add(-x[j], own[i], x[i]);
    }
  }
}

}  // namespace zwang
