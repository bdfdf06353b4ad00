#include <zwang/solvers/factor/sparse_face.h>

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
  place_.resize(rows_.column.size());
  for (std::size_t e = 0; e < place_.size(); ++e) place_[e] = factor_.position(rows_.column[e]);
  weight_.assign(at(rows_.rows()), 1);
  mass_.clear();
  for (Index j = 0; j < M_.cols(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(M_, j); it; ++it)
      if (const int r = factor_.position(static_cast<int>(it.row())), c = factor_.position(static_cast<int>(j));
          r >= 0 && c >= 0)
        mass_.push_back({r, c, it.value()});
}

void SparseFace::slack(const Vector& v, Vector& s) const {
  for (int i = 0; i < rows_.rows(); ++i) {
    double sum = 0;
    for (auto e = at(rows_.begin[at(i)]); e < at(rows_.begin[at(i) + 1]); ++e) sum += rows_.value[e] * v[place_[e]];
    s[i] = sum;
  }
}

void SparseFace::force(const Vector& l, Vector& f) const {
  f.setZero();
  for (int i = 0; i < rows_.rows(); ++i)
    if (l[i] != 0)
      for (auto e = at(rows_.begin[at(i)]); e < at(rows_.begin[at(i) + 1]); ++e) f[place_[e]] += rows_.value[e] * l[i];
}

void SparseFace::mass(const Vector& v, Vector& f) const {
  f.setZero();
  for (const auto& e : mass_) f[e.row] += e.value * v[e.column];
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

}  // namespace zwang
