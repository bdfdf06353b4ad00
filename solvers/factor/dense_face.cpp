#include <zwang/solvers/factor/dense_face.h>

#include <algorithm>
#include <cmath>

#include <zwang/solvers/linalg/lanes.h>

namespace zwang {
namespace {

using lanes::Lanes;
constexpr Index width = lanes::width, panel = 8, tile = 4;
constexpr Index block = 96;       // rows whose tiles stay in the first cache
constexpr Index most_parts = 64;  // of a row

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
  if (G_.rows() != padded_ || G_.cols() < rows_) G_.resize(padded_, rows_);
  G_.leftCols(rows_).setZero();
  ordered_.setZero(padded_);
  if (H_.rows() != padded_) {
    A_.resize(padded_, block);
    DG_.resize(padded_, block);
    H_.setZero(padded_, padded_);
    across_.setZero(padded_, panel);
    for (Vector* x : {&reciprocal_, &free_}) x->setZero(padded_);
    L_.setZero(padded_, padded_);
    pivot_.resize(at(padded_));
  }
}

// Contacts and single rows are sorted by where they have entries: a contact of a hand has them at the palm's unknowns
// and at its own finger's, 10 of 26, and G'D G none but there.
void DenseFace::rows_are_set() {
  step_ = tile * ((padded_ + tile * most_parts - 1) / (tile * most_parts));
  items_.clear();
  for (Index k = 0; k < cones_ + rays_; ++k) {
    Item item{.row = k < cones_ ? 3 * k : 2 * cones_ + k, .rows = k < cones_ ? 3 : 1};
    for (Index first = 0, part = 0; first < size_; first += step_, ++part)
      if ((G_.block(first, item.row, std::min(step_, padded_ - first), item.rows).array() != 0).any())
        item.parts |= std::uint64_t{1} << part;
    items_.push_back(item);
  }
  std::ranges::sort(items_, {}, [](const Item& item) { return std::pair(item.parts, item.row); });
  lanes_.reset(size_, rows_);
  lanes_.take(G_, 0, rows_);
  slack_.setZero(lanes::round_up(rows_));
}

void DenseFace::slack(const Vector& v, Vector& s) const {
  slack_.setZero();
  lanes_.accumulate(1, v.data(), slack_.data());
  s = slack_.head(rows_);
}

void DenseFace::force(const Vector& l, Vector& f) const {
  f.setZero();
  lanes::accumulate(G_, rows_, l.data(), f.data(), 0, padded_);
}

// Rows of one item side by side in A_, and D of them in DG_; those without weight, as of open contacts, add nothing.
Index DenseFace::pack(const Item& item, const std::vector<double>& D, const Vector& ray_weight, Index count) {
  if (item.rows == 1) {
    const double weight = ray_weight[item.row - 3 * cones_];
    if (weight == 0) return 0;
    for (const Index i : vectors_) {
      lanes::at(&A_(i, count), 0) = lanes::at(&G_(i, item.row), 0);
      lanes::at(&DG_(i, count), 0) = weight * lanes::at(&G_(i, item.row), 0);
    }
    return 1;
  }
  const double* d = &D[at(3 * item.row)];
  if (std::all_of(d, d + 9, [](double x) { return x == 0; })) return 0;
  for (const Index i : vectors_) {
    const Lanes x = lanes::at(&G_(i, item.row), 0), y = lanes::at(&G_(i, item.row + 1), 0),
                z = lanes::at(&G_(i, item.row + 2), 0);
    lanes::at(&A_(i, count), 0) = x;
    lanes::at(&A_(i, count + 1), 0) = y;
    lanes::at(&A_(i, count + 2), 0) = z;
    for (Index q = 0; q < 3; ++q)
      lanes::at(&DG_(i, count + q), 0) = multiply_add(d[q + 6], z, multiply_add(d[q + 3], y, (d[q] * x).eval()).eval());
  }
  return 3;
}

// Where rows with those parts have entries, by vectors and by tiles.
void DenseFace::find_parts(std::uint64_t parts) {
  const auto within = [&](Index first, Index count) {
    bool any = false;
    for (Index i = first; i < first + count; i += tile) any = any || (parts >> (i / step_) & 1) != 0;
    return any;
  };
  vectors_.clear();
  tiles_.clear();
  for (Index i = 0; i < padded_; i += width)
    if (within(i, width)) vectors_.push_back(i);
  for (Index j = 0; j < size_; j += tile)
    if (within(j, tile)) tiles_.push_back(j);
}

bool DenseFace::factorize(const std::vector<double>& D, const Vector& ray_weight, bool symmetric) {
  symmetric_ = symmetric;
  H_.setIdentity();
  for (std::size_t first = 0, next = 0; first < items_.size(); first = next) {
    if (first == 0 || items_[first].parts != items_[first - 1].parts) find_parts(items_[first].parts);
    Index count = 0;
    for (; next < items_.size() && items_[next].parts == items_[first].parts && count + 3 <= block; ++next)
      count += pack(items_[next], D, ray_weight, count);
    for (const Index j : tiles_)
      for (const Index i : vectors_)
        if (!symmetric || i >= j / width * width)
          add_tile<1>(&A_(i, 0), padded_, &DG_(j, 0), padded_, count, &H_(i, j), padded_);
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

// A panel's own rows by numbers, then what they are to the other rows.
void DenseFace::solve(Vector& x) {
  if (!symmetric_) return solve_lu(x);
  for (Index begin = 0; begin < size_; begin += panel) {
    const Index end = std::min(begin + panel, size_);
    for (Index j = begin; j < end; ++j) {
      x[j] *= reciprocal_[j];
      for (Index i = j + 1; i < end; ++i) x[i] = multiply_add(-x[j], H_(i, j), x[i]);
    }
    if (end < size_) lanes::subtract(H_.middleCols(begin, panel), panel, &x[begin], x.data(), end, padded_);
  }
  for (Index begin = (size_ - 1) / panel * panel; begin >= 0; begin -= panel) {
    const Index end = std::min(begin + panel, size_);
    for (Index j = begin; end < size_ && j < end; ++j)
      x[j] -= lanes::dot(H_.col(j).data() + end, &x[end], padded_ - end);
    for (Index j = end - 1; j >= begin; --j) {
      x[j] *= reciprocal_[j];
      for (Index i = begin; i < j; ++i) x[i] = multiply_add(-x[j], H_(j, i), x[i]);
    }
  }
}

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

double DenseFace::along(Index r, const Vector& v) const { return lanes::dot(G_.col(r).data(), v.data(), padded_); }

void DenseFace::push(Index r, double l, Vector& v) const { lanes::add(l, G_.col(r).data(), v.data(), padded_); }

double DenseFace::delassus(Index r, Index q) const { return lanes::dot(G_.col(r).data(), G_.col(q).data(), padded_); }

}  // namespace zwang
