#include <zwang/solvers/factor/updated_cholesky.h>

#include <Eigen/CholmodSupport>

#include <algorithm>
#include <cmath>
#include <limits>

namespace zwang {

struct UpdatedCholesky::Cholmod {
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
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  double pivot(Index j) const { return static_cast<double*>(L->x)[static_cast<int*>(L->p)[j]]; }
  bool ok() const { return common.status >= CHOLMOD_OK; }
};

bool UpdatedCholesky::reset(Index size) {
  c_.open().common.status = CHOLMOD_OK;
  if (c_->L && c_->L->n == static_cast<std::size_t>(size)) {
    // Back to the identity, column by column, in the storage that the columns have grown.
    const auto* first = static_cast<const int*>(c_->L->p);
    for (Index j = 0; j < size; ++j) {
      static_cast<int*>(c_->L->nz)[j] = 1;
      static_cast<int*>(c_->L->i)[first[j]] = static_cast<int>(j);
      static_cast<double*>(c_->L->x)[first[j]] = 1;
    }
    return true;
  }
  cholmod_free_factor(&c_->L, &c_->common);
  if (size == 0) return true;
  c_->L = cholmod_allocate_factor(static_cast<std::size_t>(size), &c_->common);
  if (!c_->L) return false;
  // CHOLMOD alone gives a column 6 entries, and moves and packs all of them as one grows.
  constexpr Index room = 32;
  for (Index j = 0; j < size; ++j) static_cast<int*>(c_->L->ColCount)[j] = static_cast<int>(std::min(room, size - j));
  return cholmod_change_factor(CHOLMOD_REAL, 0, 0, 0, 0, c_->L, &c_->common);
}

bool UpdatedCholesky::add(Index at, std::span<const int> index, std::span<const double> value) {
  int first[2] = {0, static_cast<int>(index.size())};
  Eigen::Map<SparseMatrix> column(static_cast<Index>(c_->L->n), 1, first[1], first, const_cast<int*>(index.data()),
                                  const_cast<double*>(value.data()));
  cholmod_sparse view = Eigen::viewAsCholmod(Eigen::Ref<SparseMatrix>(column));
  view.stype = 0;
  return cholmod_rowadd(static_cast<std::size_t>(at), &view, c_->L, &c_->common) && c_->ok() && smallest_pivot() > 0;
}

bool UpdatedCholesky::remove(Index at) {
  return cholmod_rowdel(static_cast<std::size_t>(at), nullptr, c_->L, &c_->common) && c_->ok() && smallest_pivot() > 0;
}

// NaN, not only a pivot <= 0, must fail `> 0`.
double UpdatedCholesky::smallest_pivot() const {
  double smallest = std::numeric_limits<double>::infinity();
  for (Index j = 0; c_->L && j < static_cast<Index>(c_->L->n); ++j) {
    const double d = c_->pivot(j);
    if (!std::isfinite(d)) return std::numeric_limits<double>::quiet_NaN();
    smallest = std::min(smallest, d);
  }
  return smallest;
}

double UpdatedCholesky::rcond() const {
  double largest = 0;
  for (Index j = 0; c_->L && j < static_cast<Index>(c_->L->n); ++j) largest = std::max(largest, c_->pivot(j));
  return largest > 0 ? smallest_pivot() / largest : 1;
}

// Column by column over CHOLMOD's own arrays: cholmod_solve2 allocates its workspace at every call.
void UpdatedCholesky::solve(Vector& x) const {
  if (x.size() == 0) return;
  const auto *first = static_cast<const int*>(c_->L->p), *count = static_cast<const int*>(c_->L->nz),
             *row = static_cast<const int*>(c_->L->i);
  const auto* value = static_cast<const double*>(c_->L->x);
  const int n = static_cast<int>(x.size());
  for (int j = 0; j < n; ++j)
    for (int p = first[j] + 1; p < first[j] + count[j]; ++p) x[row[p]] -= value[p] * x[j];
  for (int j = n - 1; j >= 0; --j) {
    x[j] /= value[first[j]];
    for (int p = first[j] + 1; p < first[j] + count[j]; ++p) x[j] -= value[p] * x[row[p]];
  }
}

}  // namespace zwang
