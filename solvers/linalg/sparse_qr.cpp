#include <zwang/solvers/linalg/sparse_qr.h>

#include <Eigen/CholmodSupport>
#include <SuiteSparseQR.hpp>
#include <algorithm>
#include <cmath>
#include <new>

#include <zwang/core/problem/sparsity_pattern.h>
#include <zwang/solvers/linalg/library_memory.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {
namespace {

using Long = SuiteSparse_long;

constexpr Index few_unknowns = 200, few_rows = 16;  // below, reflections in dense columns are as quick
constexpr double dense_share = 0.05;                // of entries
constexpr double operations_per_second = 2e9;       // less than a slow core does, against the time that is left

using Columns = Eigen::SparseMatrix<double, Eigen::ColMajor, Long>;
using Dense = Eigen::Ref<const Matrix, 0, Eigen::OuterStride<>>;
using Answer = Eigen::Map<const Matrix>;

}  // namespace

struct SparseQr::Factors {
  LibraryMemory memory;
  cholmod_common common{};
  SuiteSparseQR_factorization<double>* qr = nullptr;
  Columns columns;         // G_E'
  SparsityPattern places;  // of the analysis
  double work = 0;         // operations, by the analysis
  Vector all, x;           // storage of the calls below
  Matrix some, rotated;

  Factors() {
    const LibraryMemory::Use use(memory);
    cholmod_l_start(&common);
    common.print = 0;
  }
  ~Factors() {
    const LibraryMemory::Use use(memory);
    forget();
    cholmod_l_finish(&common);
  }
  Factors(Factors&&) = delete;

  void forget() {
    if (qr) SuiteSparseQR_free(&qr, &common);
    places = {};
  }
  // `call` on X and `take` on its answer.
  template <class Call, class Take>
  void apply(Call&& call, Dense x, Take&& take) {
    const LibraryMemory::Use use(memory);
    cholmod_dense X = Eigen::viewAsCholmod(x);
    const auto free = [this](cholmod_dense* Y) { cholmod_l_free_dense(&Y, &common); };
    const std::unique_ptr<cholmod_dense, decltype(free)> Y(call(&X), free);
    if (!Y) throw std::bad_alloc();
    take(Answer(static_cast<const double*>(Y->x), static_cast<Index>(Y->nrow), static_cast<Index>(Y->ncol)));
  }
  template <class Take>
  void multiply(int side, const Dense& x, Take&& take) {
    apply([&](cholmod_dense* X) { return SuiteSparseQR_qmult<double>(side, qr, X, &common); }, x, take);
  }
  template <class Take>
  void solve(int system, const Dense& x, Take&& take) {
    apply([&](cholmod_dense* X) { return SuiteSparseQR_solve<double>(system, qr, X, &common); }, x, take);
  }
};

// False where the rows are not sparse.
bool SparseQr::load(const Rows& G, const std::vector<Index>& rows) {
  Columns& columns = factors_->columns;
  const auto most = static_cast<Index>(dense_share * static_cast<double>(G.cols() * std::ssize(rows)));
  columns.resize(G.cols(), std::ssize(rows));
  for (Index k = 0; const Index i : rows) {
    columns.startVec(k);
    for (Rows::InnerIterator it(G, i); it; ++it) columns.insertBack(it.col(), k) = it.value();
    if (columns.data().size() > most) return false;
    ++k;
  }
  columns.finalize();
  return true;
}

bool SparseQr::factorize(const Rows& G, const std::vector<Index>& rows, double tolerance, const Deadline& deadline) {
  holds_ = false;
  deadline_ = deadline;
  n_ = G.cols();
  if (n_ < few_unknowns || std::ssize(rows) < few_rows) return false;
  Factors& f = factors_.open();
  if (!load(G, rows)) return false;
  deadline.keep();

  const LibraryMemory::Use use(f.memory);
  cholmod_sparse A = Eigen::viewAsCholmod(Eigen::Ref<Columns>(f.columns));
  A.stype = 0;
  if (!f.qr || !f.places.matches(f.columns)) {
    f.forget();
    f.qr = SuiteSparseQR_symbolic<double>(SPQR_ORDERING_AMD, true, &A, &f.common);
    if (!f.qr) return false;
    f.work = f.common.SPQR_flopcount_bound;
    f.places.keep(f.columns);
  }
  const auto n = static_cast<double>(n_), m = static_cast<double>(rows.size());
  const double in_dense_columns = 2 * std::min(n, m) * n * m;
  if (f.work > std::min(in_dense_columns, operations_per_second * deadline.left())) return false;
  if (!SuiteSparseQR_numeric<double>(tolerance, &A, f.qr, &f.common)) return false;
  deadline.keep();

  list_columns();
  estimate_smallest();
  return holds_ = smallest_ >= tolerances::clear_pivot;
}

// Column k of R is row Q1fill[k]; Rmap tells the accepted ones in a matrix that is short of rank.
void SparseQr::list_columns() {
  const SuiteSparseQR_factorization<double>& qr = *factors_->qr;
  order_.clear();
  place_.clear();
  rejected_.clear();
  for (Index k = 0; k < qr.nacols; ++k) {
    const Index row = qr.Q1fill ? qr.Q1fill[k] : k;
    if (qr.Rmap && qr.Rmap[k] >= qr.rank) {
      rejected_.push_back(row);
      continue;
    }
    order_.push_back(row);
    place_.push_back(k);
  }
}

void SparseQr::multiply(bool transposed, Eigen::Ref<Matrix> X) const {
  factors_->multiply(transposed ? SPQR_QTX : SPQR_QX, X.topRows(n_), [&](const Answer& Y) { X.topRows(n_) = Y; });
}

void SparseQr::reduce(const Rows& G, std::span<const Index> rows, Matrix& A) const {
  const auto free = n_ - static_cast<Index>(order_.size()), m = std::ssize(rows);
  Matrix& some = factors_->some;
  some.resize(n_, together);
  A.resize(free, m);
  for (Index first = 0; first < m; first += together) {
    deadline_.keep();
    const Index count = std::min(together, m - first);
    some.leftCols(count).setZero();
    for (Index j = 0; j < count; ++j)
      for (Rows::InnerIterator it(G, rows[at(first + j)]); it; ++it) some(it.col(), j) = it.value();
    factors_->multiply(SPQR_QTX, some.leftCols(count),
                       [&](const Answer& y) { A.middleCols(first, count) = y.bottomRows(free); });
  }
}

void SparseQr::solve(Eigen::Ref<Matrix> W) const {
  Matrix& rotated = factors_->rotated;
  if (rotated.rows() != n_ || rotated.cols() < W.cols()) rotated.resize(n_, W.cols());
  auto own = rotated.leftCols(W.cols());
  own.topRows(W.rows()) = W;
  own.bottomRows(n_ - W.rows()).setZero();
  factors_->solve(SPQR_RX_EQUALS_B, own, [&](const Answer& Y) {
    for (Index k = 0; const Index place : place_) W.row(k++) = Y.row(place);
  });
}

void SparseQr::solve_transposed(Vector& w) const {
  Vector& all = factors_->all;
  all.setZero(factors_->qr->nacols);
  for (Index k = 0; const Index place : place_) all[place] = w[k++];
  factors_->solve(SPQR_RTX_EQUALS_B, all, [&](const Answer& y) { w = y.col(0).head(w.size()); });
}

// Inverse iteration with R'R from alternating signs: a few steps come within a small factor.
void SparseQr::estimate_smallest() {
  constexpr int steps = 4;
  smallest_ = 1;
  if (order_.empty()) return;
  Vector& x = factors_->x;
  x.resize(static_cast<Index>(order_.size()));
  for (Index k = 0; k < x.size(); ++k) x[k] = (k * 7 % 5 < 2 ? -1 : 1) * (1 + 0.1 * static_cast<double>(k % 3));
  for (int step = 0; step < steps; ++step) {
    x.normalize();
    solve_transposed(x);
    solve(x);
    const double length = x.norm();
    smallest_ = std::isfinite(length) ? std::min(smallest_, 1 / std::sqrt(length)) : 0;
  }
}

}  // namespace zwang
