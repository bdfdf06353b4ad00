#include <zwang/solvers/factor/sparse_face.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {
namespace {

// D = L L' of a positive semidefinite 3 x 3 block; pivots at rounding of what they were are zero.
void factorize_block(const double* D, double* L) {
  double a[9];
  std::copy_n(D, 9, a);
  for (int j = 0; j < 3; ++j) {
    const double pivot = a[4 * j];
    const double root = pivot > tolerances::cone_pivot * D[4 * j] ? std::sqrt(pivot) : 0;
    for (int i = 0; i < 3; ++i) L[3 * j + i] = i < j || root == 0 ? 0 : a[3 * j + i] / root;
    for (int k = j + 1; k < 3; ++k)
      for (int i = k; i < 3; ++i) a[3 * k + i] -= L[3 * j + i] * L[3 * j + k];
  }
}

}  // namespace

void SparseFace::reset(const Problem& problem, const SparseRows& rows, Index cones, const SolveOptions& options,
                       const Deadline& deadline) {
  M_ = problem.M;
  rows_ = rows;
  scaled_ = rows;
  cones_ = cones;
  deadline_ = deadline;
  couples_ = coupled_ = false;
  sum_.forget();
  factor_.analyze(M_, rows_, options, deadline, static_cast<int>(cones));
  weight_.assign(at(rows_.rows()), 1);
  factor_.list(M_, rows_, mass_, place_);
}

void SparseFace::slack(const Vector& v, Vector& s) const {
  for (Index i = 0; i < rows_.rows(); ++i) s[i] = along(i, v);
}

void SparseFace::force(const Vector& l, Vector& f) const {
  f.setZero();
  for (int i = 0; i < rows_.rows(); ++i)
    if (l[i] != 0)
      for (auto e = at(rows_.begin[at(i)]); e < at(rows_.begin[at(i) + 1]); ++e) f[place_[e]] += rows_.value[e] * l[i];
}

bool SparseFace::factorize(const std::vector<double>& D, const Vector& ray_weight, bool symmetric) {
  coupled_ = !symmetric;
  if (coupled_) return sum_.factorize(static_cast<int>(unknowns()), mass_, rows_, place_, D, ray_weight);
  double L[9];
  for (Index k = 0; k < cones_; ++k) {
    const auto first = at(rows_.begin[at(3 * k)]);
    const auto width = at(rows_.begin[at(3 * k) + 1]) - first;
    factorize_block(D.data() + 9 * k, L);
    const double *x = rows_.value.data() + first, *y = x + width, *z = y + width;
    double* out = scaled_.value.data() + first;
    for (int q = 0; q < 3; ++q, out += width) {
      weight_[at(3 * k + q)] = L[4 * q] != 0 ? 1 : 0;
      for (std::size_t e = 0; e < width; ++e) out[e] = L[3 * q] * x[e] + L[3 * q + 1] * y[e] + L[3 * q + 2] * z[e];
    }
  }
  for (Index r = 0; r < ray_weight.size(); ++r) weight_[at(3 * cones_ + r)] = ray_weight[r];
  factor_.invalidate();
  return factor_.factorize(M_, scaled_, weight_, deadline_);
}

// Bodies have six unknowns; what M ties beyond this many would make a row's image dense.
bool SparseFace::invert_mass() {
  constexpr Index most_tied = 48;
  const Index n = unknowns();
  tied_.reset(n);
  for (const auto& e : mass_)
    if (e.value != 0) tied_.join(e.row, e.column);
  block_of_.assign(at(n), -1);
  order_.assign(at(n), 0);
  blocks_.clear();
  for (Index j = 0; j < n; ++j) {
    const int block = block_of_[at(j)] = block_of_[at(tied_.find(j))];  // of the first one of them
    if (block < 0) {
      block_of_[at(j)] = static_cast<int>(blocks_.size());
      blocks_.push_back({0, 0});
    }
    order_[at(j)] = static_cast<int>(blocks_[at(block_of_[at(j)])].inverse++);  // counts
  }
  std::size_t members = 0, entries = 0;
  for (Block& block : blocks_) {
    const std::size_t size = block.inverse;
    if (static_cast<Index>(size) > most_tied) return false;
    block = {members, entries};
    members += size;
    entries += size * size;
  }
  blocks_.push_back({members, entries});
  members_.assign(members, 0);
  inverse_.assign(entries, 0);
  const auto size_of = [&](const Block& block) { return static_cast<Index>((&block)[1].first - block.first); };
  for (Index j = 0; j < n; ++j) members_[blocks_[at(block_of_[at(j)])].first + at(order_[at(j)])] = static_cast<int>(j);
  for (const auto& e : mass_) {
    if (e.value == 0) continue;
    const Block& block = blocks_[at(block_of_[at(e.row)])];
    inverse_[block.inverse + at(order_[at(e.column)] * size_of(block) + order_[at(e.row)])] = e.value;
  }
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_tied, most_tied>;
  for (std::size_t b = 0; b + 1 < blocks_.size(); ++b) {
    const Index size = size_of(blocks_[b]);
    Eigen::Map<Matrix> own(inverse_.data() + blocks_[b].inverse, size, size);
    const Eigen::LLT<Small> factor{Small(own)};
    own = factor.solve(Small::Identity(size, size));
  }
  return inverse_.empty() || Eigen::Map<const Vector>(inverse_.data(), std::ssize(inverse_)).allFinite();
}

bool SparseFace::divide_rows() {
  if (!invert_mass()) return false;
  scattered_.setZero(unknowns());
  images_.begin.assign(1, 0);
  images_.column.clear();
  images_.value.clear();
  for (int i = 0; i < rows_.rows(); ++i) {
    row_blocks_.clear();
    for (auto e = at(rows_.begin[at(i)]); e < at(rows_.begin[at(i) + 1]); ++e) {
      scattered_[place_[e]] = rows_.value[e];
      row_blocks_.push_back(block_of_[at(place_[e])]);
    }
    std::ranges::sort(row_blocks_);
    row_blocks_.erase(std::unique(row_blocks_.begin(), row_blocks_.end()), row_blocks_.end());
    for (const int b : row_blocks_) {
      const std::size_t first = blocks_[at(b)].first, size = blocks_[at(b) + 1].first - first;
      const double* column = inverse_.data() + blocks_[at(b)].inverse;
      for (std::size_t q = 0; q < size; ++q, column += size) {
        double sum = 0;
        for (std::size_t r = 0; r < size; ++r) sum += column[r] * scattered_[members_[first + r]];
        images_.column.push_back(members_[first + q]);
        images_.value.push_back(sum);
      }
    }
    images_.begin.push_back(static_cast<int>(images_.column.size()));
    for (auto e = at(rows_.begin[at(i)]); e < at(rows_.begin[at(i) + 1]); ++e) scattered_[place_[e]] = 0;
  }
  return true;
}

double SparseFace::along(Index r, const Vector& v) const {
  double sum = 0;
  for (auto e = at(rows_.begin[at(r)]); e < at(rows_.begin[at(r) + 1]); ++e) sum += rows_.value[e] * v[place_[e]];
  return sum;
}

void SparseFace::push(Index r, double l, Vector& v) const {
  if (l == 0) return;
  for (auto e = at(images_.begin[at(r)]); e < at(images_.begin[at(r) + 1]); ++e)
    v[images_.column[e]] += images_.value[e] * l;
}

double SparseFace::delassus(Index r, Index q) const {
  push(q, 1, scattered_);
  const double product = along(r, scattered_);
  for (auto e = at(images_.begin[at(q)]); e < at(images_.begin[at(q) + 1]); ++e) scattered_[images_.column[e]] = 0;
  return product;
}

}  // namespace zwang
