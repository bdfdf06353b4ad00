#include <zwang/solvers/factor/cholesky_rows.h>

#include <Eigen/CholmodSupport>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace zwang {

// S_A = L D L' of a sparse symmetric matrix whose rows and columns come and go: CHOLMOD's simplicial factor with
// rowadd and rowdel (Davis & Hager 2005, SIAM J. Matrix Anal. 26). Rows that are out stand as rows of the identity.
//
// CHOLMOD's modify module, used here, is under the GPL.
//
// What CHOLMOD (SuiteSparse 5.12) does not say: rowadd accepts a pivot of -1.7e-17 with success, a singular
// factor solves to NaN with success, and a large update followed by its downdate leaves its error behind. So the
// caller asks rcond() after every change and checks residuals. False from any call: no memory, or a pivot that is not
// positive; the factor is then to be reset.
struct CholeskyRows::Cholmod {
  cholmod_common common = {};
  cholmod_factor* L = nullptr;

  Cholmod() {
    cholmod_start(&common);
    common.print = 0;
    common.error_handler = nullptr;
  }
  ~Cholmod() {
    cholmod_free_factor(&L, &common);
    cholmod_finish(&common);
  }
  Cholmod(Cholmod&&) = delete;

  // The identity; storage is kept when the size stays.
  bool reset(Index size) {
    common.status = CHOLMOD_OK;
    if (L && L->n == static_cast<std::size_t>(size)) {
      // Column by column, in the storage that the columns have grown.
      const auto* first = static_cast<const int*>(L->p);
      for (Index j = 0; j < size; ++j) {
        static_cast<int*>(L->nz)[j] = 1;
        static_cast<int*>(L->i)[first[j]] = static_cast<int>(j);
        static_cast<double*>(L->x)[first[j]] = 1;
      }
      return true;
    }
    cholmod_free_factor(&L, &common);
    if (size == 0) return true;
    L = cholmod_allocate_factor(static_cast<std::size_t>(size), &common);
    if (!L) return false;
    // CHOLMOD alone gives a column 6 entries, and moves and packs all of them as one grows.
    constexpr Index room = 32;
    for (Index j = 0; j < size; ++j) static_cast<int*>(L->ColCount)[j] = static_cast<int>(std::min(room, size - j));
    return cholmod_change_factor(CHOLMOD_REAL, 0, 0, 0, 0, L, &common);
  }

  // Column `at` of S: ascending indices among the rows that are in and `at` itself.
  bool add(Index at, std::span<const int> index, std::span<const double> value) {
    int first[2] = {0, static_cast<int>(index.size())};
    Eigen::Map<SparseMatrix> column(static_cast<Index>(L->n), 1, first[1], first, const_cast<int*>(index.data()),
                                    const_cast<double*>(value.data()));
    cholmod_sparse view = Eigen::viewAsCholmod(Eigen::Ref<SparseMatrix>(column));
    view.stype = 0;
    return cholmod_rowadd(static_cast<std::size_t>(at), &view, L, &common) && is_positive();
  }
  bool remove(Index at) { return cholmod_rowdel(static_cast<std::size_t>(at), nullptr, L, &common) && is_positive(); }

  double pivot(Index j) const { return static_cast<double*>(L->x)[static_cast<int*>(L->p)[j]]; }
  bool is_positive() const { return common.status >= CHOLMOD_OK && smallest_pivot() > 0; }
  // Of D. NaN, not only a pivot <= 0, must fail `> 0`.
  double smallest_pivot() const {
    double smallest = infinity;
    for (Index j = 0; L && j < static_cast<Index>(L->n); ++j) {
      const double d = pivot(j);
      if (!std::isfinite(d)) return std::numeric_limits<double>::quiet_NaN();
      smallest = std::min(smallest, d);
    }
    return smallest;
  }
  // Smallest over largest of D.
  double rcond() const {
    double largest = 0;
    for (Index j = 0; L && j < static_cast<Index>(L->n); ++j) largest = std::max(largest, pivot(j));
    return largest > 0 ? smallest_pivot() / largest : 1;
  }

  // x := S_A^-1 x. Column by column over CHOLMOD's own arrays: cholmod_solve2 allocates its workspace at every call.
  void solve(Vector& x) const {
    if (x.size() == 0) return;
    const auto *first = static_cast<const int*>(L->p), *count = static_cast<const int*>(L->nz),
               *row = static_cast<const int*>(L->i);
    const auto* value = static_cast<const double*>(L->x);
    const int n = static_cast<int>(x.size());
    for (int j = 0; j < n; ++j)
      for (int p = first[j] + 1; p < first[j] + count[j]; ++p) x[row[p]] -= value[p] * x[j];
    for (int j = n - 1; j >= 0; --j) {
      x[j] /= value[first[j]];
      for (int p = first[j] + 1; p < first[j] + count[j]; ++p) x[j] -= value[p] * x[row[p]];
    }
  }
};

double CholeskyRows::smallest_pivot() const { return size() ? std::sqrt(factor_->smallest_pivot()) : 1; }

void CholeskyRows::reset(const Whitened& w, const Deadline& deadline) {
  begin(w, deadline);
  const auto k = at(w.rows());
  index_.reserve(k);
  value_.reserve(k);
  inside_.assign(k, 0);
  x_.resize(w.rows());
  part_.resize(w.rows());
  rest_.resize(w.size());
  healthy_ = factor_.open().reset(w.rows());
}

bool CholeskyRows::refactor() {
  std::fill(inside_.begin(), inside_.end(), char(0));
  healthy_ = factor_->reset(w_->rows());
  for (const Index row : rows_) healthy_ = healthy_ && factor_row(row);
  return healthy_ && (rows_.empty() || factor_->rcond() >= tolerances::gram_rcond);
}

// Column `row` of S over the rows that are in.
bool CholeskyRows::factor_row(Index row) {
  deadline_->keep();
  inside_[at(row)] = 1;
  index_.clear();
  value_.clear();
  rest_.setZero();
  add(row, 1, rest_);
  for (Index i = 0; i < w_->rows(); ++i) {
    if (!inside_[at(i)]) continue;
    const double s = dot(i, rest_);
    if (s == 0 && i != row) continue;
    index_.push_back(static_cast<int>(i));
    value_.push_back(s);
  }
  return factor_->add(row, index_, value_);
}

double CholeskyRows::share(Index row) {
  rest_.setZero();
  add(row, 1, rest_);
  project(rest_, part_.head(size()), 3);
  return rest_.norm();
}

double CholeskyRows::append(Index row) {
  const double part = size() < w_->size() ? share(row) : 0;
  if (!accepts(part)) return part;
  rows_.push_back(row);
  if (factor_row(row) && factor_->rcond() >= tolerances::gram_rcond) return part;
  // The update failed where the row itself is sound: once more from scratch, else hand it back.
  if (refactor()) return part;
  rows_.pop_back();
  refactor();
  return threshold_;
}

void CholeskyRows::drop(Index position) {
  const Index row = (*this)[position];
  forget(position);
  inside_[at(row)] = 0;
  if (!factor_->remove(row) || (size() > 0 && factor_->rcond() < tolerances::gram_rcond)) refactor();
}

// The first pass is right to cond(S_A) eps, each more gains as many digits.
void CholeskyRows::project(Part v, Part t, int passes) {
  deadline_->keep();
  t.setZero();
  for (int pass = 0; pass < passes && size() > 0; ++pass) {
    x_.setZero();
    for (const Index i : rows_) x_[i] = dot(i, v);
    factor_->solve(x_);
    for (Index i = 0; i < size(); ++i) {
      t[i] += x_[(*this)[i]];
      add((*this)[i], -x_[(*this)[i]], v);
    }
  }
}

// S_A dl = r2 - G_A r1,  dy = r1 + G_A' dl.
void CholeskyRows::correct(Vector& r1, Part r2) {
  deadline_->keep();
  x_.setZero();
  for (Index i = 0; i < size(); ++i) x_[(*this)[i]] = r2[i] - dot((*this)[i], r1);
  if (size() > 0) factor_->solve(x_);
  for (Index i = 0; i < size(); ++i) {
    r2[i] = x_[(*this)[i]];
    add((*this)[i], r2[i], r1);
  }
}

}  // namespace zwang
