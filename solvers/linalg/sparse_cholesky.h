#pragma once

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <zwang/core/problem/sparsity_pattern.h>

namespace zwang {

// P M P' = L L' for a sparse symmetric positive definite M, any scalar.
//
// Up-looking factorization along the elimination tree (Davis, Direct Methods for Sparse Linear Systems, 2006, ch. 4).
// The symbolic part is kept as long as the pattern of M stays the same, and factorize() then allocates nothing, which
// Eigen's SimplicialLLT does at every call. A right-hand side with few entries is solved along its path in the tree
// only: a contact on one body costs that body's 6 x 6 block, not n.
template <class Scalar>
class SparseCholesky {
 public:
  using SparseMatrix = Eigen::SparseMatrix<Scalar>;

  // Both triangles of M are stored; the upper one is read. False when M is not positive definite.
  bool factorize(const SparseMatrix& M) {
    if (!places_.matches(M)) analyze(M);
    return compute(M.valuePtr());
  }

  Index size() const { return static_cast<Index>(parent_.size()); }
  int position(Index i) const { return position_[i]; }  // of M's row i in P M P'
  // Whether its column of L is zero below the pivot: x := L^-1 x divides an entry there by the pivot, no more.
  bool is_alone(int position) const { return alone_[position]; }
  const Scalar& pivot(int position) const { return value_[first_[position]]; }
  // The largest of M_jj over the square of its pivot: near cond(M) of a unit diagonal, large where M ties unknowns to
  // each other.
  const Scalar& tied() const { return tied_; }

  // x := L^-1 x, where x (in P's order) has its entries at `start`; on return at `touched`, ascending.
  template <class Column>
  void solve_lower(std::span<const int> start, Column&& x, std::vector<int>& touched) {
    touched.clear();
    for (int i : start)
      for (; i >= 0 && !mark_[i]; i = parent_[i]) {
        mark_[i] = 1;
        touched.push_back(i);
      }
    // Paths in one block of M come ascending, or nearly so.
    if (!std::is_sorted(touched.begin(), touched.end())) std::sort(touched.begin(), touched.end());
    for (const int j : touched) {
      mark_[j] = 0;
      eliminate(j, x);
    }
  }
  // x := L^-1 P x.
  void solve_lower(VectorX<Scalar>& x) const {
    for (Index i = 0; i < size(); ++i) scratch_[position(i)] = x[i];
    for (int j = 0; j < size(); ++j) eliminate(j, scratch_);
    x = scratch_;
  }
  // x := P' L^-T x.
  void solve_upper(VectorX<Scalar>& x) const {
    for (int j = static_cast<int>(size()) - 1; j >= 0; --j) {
      for (int p = first_[j] + 1; p < first_[j + 1]; ++p) x[j] -= value_[p] * x[index_[p]];
      x[j] /= value_[first_[j]];
    }
    scratch_ = x;
    for (Index i = 0; i < size(); ++i) x[i] = scratch_[position(i)];
  }
  // x := L' P x, so that |x| becomes the M-norm.
  void multiply_upper(VectorX<Scalar>& x) const {
    for (Index i = 0; i < size(); ++i) scratch_[position(i)] = x[i];
    for (int j = 0; j < size(); ++j) {
      x[j] = Scalar(0);
      for (int p = first_[j]; p < first_[j + 1]; ++p) x[j] += value_[p] * scratch_[index_[p]];
    }
  }

 private:
  template <class Column>
  void eliminate(int j, Column&& x) const {
    x[j] /= value_[first_[j]];
    for (int p = first_[j] + 1; p < first_[j + 1]; ++p) x[index_[p]] -= value_[p] * x[j];
  }

  static int column_end(const SparseMatrix& M, Index j) {
    return M.isCompressed() ? M.outerIndexPtr()[j + 1] : M.outerIndexPtr()[j] + M.innerNonZeroPtr()[j];
  }

  void analyze(const SparseMatrix& M);
  bool compute(const Scalar* entry);

  // Row k of L: the nodes on the tree paths from the entries of column k of the upper triangle, in topological order.
  int reach(int k) {
    int top = static_cast<int>(size());
    mark_[k] = 1;
    for (int p = upper_first_[k]; p < upper_first_[k + 1]; ++p) {
      int length = 0;
      for (int i = upper_index_[p]; !mark_[i]; i = parent_[i]) {
        path_[length++] = i;
        mark_[i] = 1;
      }
      while (length > 0) row_[--top] = path_[--length];
    }
    for (int i = top; i < size(); ++i) mark_[row_[i]] = 0;
    mark_[k] = 0;
    return top;
  }

  SparsityPattern places_;                                   // M's at the last analyze()
  std::vector<int> position_;                                // P: M's row -> row of L
  std::vector<int> parent_;                                  // elimination tree, -1 at a root
  std::vector<int> upper_first_, upper_index_, upper_from_;  // upper triangle of P M P', and where it stands in M
  std::vector<int> first_, index_, fill_;                    // L by columns, diagonal first
  std::vector<Scalar> value_;
  Scalar tied_{1};
  std::vector<char> alone_;
  std::vector<int> mark_, row_, path_;
  mutable VectorX<Scalar> scratch_;
};

template <class Scalar>
void SparseCholesky<Scalar>::analyze(const SparseMatrix& M) {
  const int n = static_cast<int>(M.cols());
  const auto size = at(n);
  Eigen::SparseMatrix<double> shape = M.unaryExpr([](const Scalar&) { return 1.0; });
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(shape, order);
  position_.resize(size);
  for (int i = 0; i < n; ++i) position_[order.indices()[i]] = i;

  // The upper triangle of P M P', counted, then filled.
  upper_first_.assign(size + 1, 0);
  const auto each_upper = [&](auto&& visit) {
    for (int j = 0; j < n; ++j)
      for (int p = M.outerIndexPtr()[j]; p < column_end(M, j); ++p) {
        const int r = position_[M.innerIndexPtr()[p]];
        const int c = position_[j];
        if (r <= c) visit(r, c, p);
      }
  };
  each_upper([&](int, int c, int) { ++upper_first_[c + 1]; });
  for (int j = 0; j < n; ++j) upper_first_[j + 1] += upper_first_[j];
  upper_index_.resize(at(upper_first_[n]));
  upper_from_.resize(upper_index_.size());
  fill_ = upper_first_;
  each_upper([&](int r, int c, int p) {
    upper_from_[fill_[c]] = p;
    upper_index_[fill_[c]++] = r;
  });

  // Elimination tree with path compression.
  parent_.assign(size, -1);
  std::vector<int> ancestor(size, -1);
  for (int k = 0; k < n; ++k)
    for (int p = upper_first_[k]; p < upper_first_[k + 1]; ++p)
      for (int i = upper_index_[p], next = -1; i >= 0 && i < k; i = next) {
        next = ancestor[i];
        ancestor[i] = k;
        if (next < 0) parent_[i] = k;
      }

  // Column counts by walking every row once.
  mark_.assign(size, 0);
  row_.resize(size);
  path_.resize(size);
  first_.assign(size + 1, 0);
  for (int k = 0; k < n; ++k) {
    ++first_[k + 1];
    for (int t = reach(k); t < n; ++t) ++first_[row_[t] + 1];
  }
  for (int j = 0; j < n; ++j) first_[j + 1] += first_[j];
  index_.resize(at(first_[n]));
  value_.resize(index_.size());
  scratch_.resize(n);
  places_.keep(M);
}

template <class Scalar>
bool SparseCholesky<Scalar>::compute(const Scalar* entry) {
  using std::sqrt;
  const int n = static_cast<int>(size());
  fill_.assign(first_.begin(), first_.end());
  scratch_.setZero();
  tied_ = Scalar(1);
  for (int k = 0; k < n; ++k) {
    for (int p = upper_first_[k]; p < upper_first_[k + 1]; ++p) scratch_[upper_index_[p]] += entry[upper_from_[p]];
    const Scalar own = scratch_[k];
    Scalar diagonal = own;
    scratch_[k] = Scalar(0);
    for (int t = reach(k); t < n; ++t) {
      const int i = row_[t];
      const Scalar l = scratch_[i] / value_[first_[i]];
      scratch_[i] = Scalar(0);
      for (int p = first_[i] + 1; p < fill_[i]; ++p) scratch_[index_[p]] -= value_[p] * l;
      diagonal -= l * l;
      index_[fill_[i]] = k;
      value_[fill_[i]++] = l;
    }
    if (!(diagonal > Scalar(0))) return false;
    if (own > tied_ * diagonal) tied_ = own / diagonal;
    index_[fill_[k]] = k;
    value_[fill_[k]++] = sqrt(diagonal);
  }
  alone_.resize(parent_.size());
  for (int j = 0; j < n; ++j)
    alone_[j] = std::all_of(value_.begin() + first_[j] + 1, value_.begin() + first_[j + 1],
                            [](const Scalar& l) { return l == Scalar(0); });
  return true;
}

}  // namespace zwang
