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
  ordered_.setZero(padded_);
  if (H_.rows() != padded_) {
    H_.setZero(padded_, padded_);
    across_.setZero(padded_, panel);
    for (Vector* x : {&reciprocal_, &free_}) x->setZero(padded_);
    L_.setZero(padded_, padded_);
    pivot_.resize(at(padded_));
  }
}

void DenseFace::slack(const Vector& v, Vector& s) const {
  lanes::multiply_transposed(G_, rows_, v.data(), s.data(), padded_);
}

void DenseFace::force(const Vector& l, Vector& f) const {
  f.setZero();
  lanes::accumulate(G_, rows_, l.data(), f.data(), 0, padded_);
}

// Rows without weight, those of open contacts, add nothing: the others are then copied side by side.
Index DenseFace::pack(const std::vector<double>& D, const Vector& ray_weight) {
  const auto weighs = [&](Index k) {
    return std::any_of(&D[at(9 * k)], &D[at(9 * k)] + 9, [](double x) { return x != 0; });
  };
  packed_ = ray_weight.size() > 0 && (ray_weight.array() == 0).any();
  for (Index k = 0; k < cones_ && !packed_; ++k) packed_ = !weighs(k);
  Index count = 0;
  for (Index k = 0; k < cones_; ++k) {
    if (!weighs(k)) continue;
    const double* d = &D[at(9 * k)];
    const double *x = row(3 * k), *y = row(3 * k + 1), *z = row(3 * k + 2);
    for (Index q = 0; q < 3; ++q, ++count) {
      double* out = DG_.col(count).data();
      for (Index i = 0; i < padded_; i += width)
        lanes::at(out, i) = multiply_add(
            d[q + 6], lanes::at(z, i), multiply_add(d[q + 3], lanes::at(y, i), (d[q] * lanes::at(x, i)).eval()).eval());
      if (packed_) A_.col(count) = G_.col(3 * k + q);
    }
  }
  for (Index r = 3 * cones_; r < rows_; ++r) {
    if (ray_weight[r - 3 * cones_] == 0) continue;
    DG_.col(count) = ray_weight[r - 3 * cones_] * G_.col(r);
    if (packed_) A_.col(count) = G_.col(r);
    ++count;
  }
  return count;
}

bool DenseFace::factorize(const std::vector<double>& D, const Vector& ray_weight, bool symmetric) {
  symmetric_ = symmetric;
  const Index rows = pack(D, ray_weight);
  const lanes::Columns& A = packed_ ? A_ : G_;
  H_.setIdentity();
  constexpr Index block = 96;  // rows whose tiles stay in the first cache
  for (Index first = 0; first < rows; first += block) {
    const Index count = std::min(block, rows - first);
    for (Index j = 0; j < size_; j += tile)
      for (Index i = symmetric ? j / width * width : 0; i < padded_; i += width)
        add_tile<1>(&A(i, first), padded_, &DG_(j, first), padded_, count, &H_(i, j), padded_);
  }
  return symmetric ? cholesky() : lu();
}

// H(:, end ..) -= L(:, begin .. end) U(begin .. end, end ..); across_ holds U's rows side by side.
void DenseFace::update(const lanes::Columns& L, Index begin, Index end, bool lower) {
  for (Index j = end; j < size_; j += tile)
    for (Index i = lower ? j / width * width : 0; i < padded_; i += width)
      add_tile<-1>(&L(i, begin), padded_, &across_(j, 0), padded_, end - begin, &H_(i, j), padded_);
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
    if (end == size_) break;
    for (Index k = 0; k < end - begin; ++k)
      for (Index j = end; j < padded_; ++j) across_(j, k) = H_(j, begin + k);
    update(H_, begin, end, true);
  }
  return true;
}

// Row exchanges that move no row: step j eliminates with row pivot_[j], which then leaves the rows that are free.
// Column j of L_ has zeros in the others, that of H_ in the free ones, so all goes in whole vectors. (Rows that moved
// took a third of a hand's cold solve with 4 contacts; of many unknowns this is half as much again of what is a small
// part.)
bool DenseFace::lu() {
  free_.setZero();
  free_.head(size_).setOnes();
  for (Index begin = 0; begin < size_; begin += panel) {
    const Index end = std::min(begin + panel, size_);
    for (Index j = begin; j < end; ++j) {
      double* own = H_.col(j).data();
      const Index pivot = largest_free(own);
      if (!(std::abs(own[pivot]) > 0) || !std::isfinite(own[pivot])) return false;
      pivot_[at(j)] = pivot;
      reciprocal_[j] = 1 / own[pivot];
      free_[pivot] = 0;
      lanes::in_parts(0, padded_, [&]<int vectors>(Index i) {
        using Part = Vec<double, vectors * width>;
        const Part left = Eigen::Map<Part>(own + i).cwiseProduct(Eigen::Map<const Part>(free_.data() + i));
        const Part low = reciprocal_[j] * left;
        Eigen::Map<Part>{own + i} -= left;
        Eigen::Map<Part>{&L_(i, j)} = low;
        for (Index k = j + 1; k < end; ++k) {
          Eigen::Map<Part> other(&H_(i, k));
          other = multiply_add(-H_(pivot, k), low, other);
        }
      });
    }
    if (end == size_) break;
    for (Index k = 0; k < end - begin; ++k)
      for (Index j = end; j < padded_; ++j) across_(j, k) = H_(pivot_[at(begin + k)], j);
    for (Index i = 0; i < end - begin; ++i)
      for (Index k = i + 1; k < end - begin; ++k)
        lanes::add(-L_(pivot_[at(begin + k)], begin + i), &across_(end, i), &across_(end, k), padded_ - end);
    update(L_, begin, end, false);
  }
  return true;
}

Index DenseFace::largest_free(const double* column) const {
  Lanes most = Lanes::Zero();
  for (Index i = 0; i < padded_; i += width)
    most = most.cwiseMax(lanes::at(column, i).cwiseAbs().cwiseProduct(lanes::at(free_.data(), i)));
  const double size = most.maxCoeff();
  Index row = 0;
  while (row + 1 < size_ && !(std::abs(column[row]) * free_[row] == size)) ++row;
  return row;
}

void DenseFace::solve(Vector& x) {
  if (!symmetric_) return solve_lu(x);
  for (Index j = 0; j < size_; ++j) {
    const double* own = H_.col(j).data();
    x[j] *= reciprocal_[j];
    for (Index i = j + 1; i < size_; ++i) x[i] = multiply_add(-x[j], own[i], x[i]);
  }
  for (Index j = size_ - 1; j >= 0; --j)
    x[j] = (x[j] - H_.col(j).segment(j + 1, size_ - j - 1).dot(x.segment(j + 1, size_ - j - 1))) * reciprocal_[j];
}

// A panel's own rows by numbers, then what they are to the other rows.
void DenseFace::solve_lu(Vector& x) {
  for (Index begin = 0; begin < size_; begin += panel) {
    const Index count = std::min(panel, size_ - begin);
    for (Index k = 0; k < count; ++k) {
      const Index row = pivot_[at(begin + k)];
      double own = x[row];
      for (Index i = 0; i < k; ++i) own = multiply_add(-L_(row, begin + i), ordered_[begin + i], own);
      ordered_[begin + k] = own;
    }
    lanes::subtract(L_.middleCols(begin, count), count, &ordered_[begin], x.data(), 0, padded_);
  }
  for (Index begin = (size_ - 1) / panel * panel; begin >= 0; begin -= panel) {
    const Index count = std::min(panel, size_ - begin);
    for (Index k = count - 1; k >= 0; --k) {
      const Index row = pivot_[at(begin + k)];
      double own = x[row];
      for (Index i = count - 1; i > k; --i) own = multiply_add(-H_(row, begin + i), ordered_[begin + i], own);
      ordered_[begin + k] = own * reciprocal_[begin + k];
    }
    lanes::subtract(H_.middleCols(begin, count), count, &ordered_[begin], x.data(), 0, padded_);
  }
  x = ordered_;
}

}  // namespace zwang
