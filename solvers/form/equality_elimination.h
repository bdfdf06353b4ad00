#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/linalg/sparse_qr.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// Orthogonal elimination of the equality rows: G_E' = Q [R; 0] by Householder reflections, and the null-space basis N
// (the part of Q that R leaves free), so that y = y_E + N v with v free.
//
// Pivoting: among the rows whose remaining part is at least `threshold` of the largest one, the row that meets the
// fewest others goes first. The reflections of a mechanism then follow its tree from the leaves, and blocks of eight
// zeros are never touched. Strict pivoting (threshold 1) couples all fingers of a hand through the palm and loses that.
// A pivot stands at the largest entry of its column, wherever that is; `pivot_entry` and `free_entry` say where the
// parts of a rotated vector stand. The remaining norms are computed afresh after every reflection: downdating them
// loses the small ones, and those are what rank decisions are made of.
//
// Many sparse rows, where no body says what hangs together, go to a sparse QR first (sparse_qr.h): it keeps its zeros,
// and leaves to the reflections what is not clear.
class EqualityElimination {
 public:
  using Rows = RowMatrix;

  // Row i is row rows[i] of G (k x n), of length 1. A row whose remaining part is at most `tolerance` is rejected.
  void factorize(const Rows& G, const std::vector<Index>& rows, double tolerance, const Deadline& deadline,
                 bool try_sparse);

  Index rank() const { return static_cast<Index>(order_.size()); }
  Index padded_size() const { return padded_size_; }
  Index freedom() const { return n_ - rank(); }
  const std::vector<Index>& order() const { return order_; }    // accepted, as positions in `rows`
  const std::vector<Index>& rejected() const { return open_; }  // likewise
  // A := N'G' of the rows of G that are listed; freedom x rows.
  void reduce(const Rows& G, const std::vector<Index>& rows, const Deadline& deadline, Matrix& A) const;
  double smallest_accepted() const { return smallest_; }  // 1 when there is none

  // X := Q'X and X := Q X, X of padded_size() rows with zeros beyond n, and together() columns at most.
  using Columns = Eigen::Ref<Matrix>;
  Index together() const { return sparse_.holds() ? SparseQr::together : 1; }
  void rotate(Columns X) const;
  void rotate_back(Columns X) const;
  // Of rotated columns their parts: W (rank, in pivot order) and V (freedom); and X from them, rotated back.
  void range(const Columns& rotated, Columns W) const {
    for (Index k = 0; k < rank(); ++k) W.row(k) = rotated.row(pivot_entry_[at(k)]);
  }
  void free(const Columns& rotated, Columns V) const {
    for (Index l = 0; l < freedom(); ++l) V.row(l) = rotated.row(free_entry_[at(l)]);
  }
  template <class Range, class Free>
  void join(const Range& W, const Free& V, Columns X) const {
    for (Index k = 0; k < rank(); ++k) X.row(pivot_entry_[at(k)]) = W.row(k);
    for (Index l = 0; l < freedom(); ++l) X.row(free_entry_[at(l)]) = V.row(l);
    rotate_back(X);
  }
  // W := R^-1 W and w := R^-T w over the first rank() rows.
  void solve(Columns W) const;
  void solve_transposed(Vector& w) const;

 private:
  static constexpr Index block = 8;
  using Mask = std::vector<std::uint64_t>;

  template <class Visit>
  void each_block(const std::uint64_t* mask, Visit&& visit) const {
    for (Index w = 0; w < words_; ++w)
      for (std::uint64_t bits = mask[w]; bits; bits &= bits - 1) visit(w * 64 + std::countr_zero(bits));
  }
  bool meet(const std::uint64_t* a, const std::uint64_t* b) const {
    for (Index w = 0; w < words_; ++w)
      if (a[w] & b[w]) return true;
    return false;
  }
  const std::uint64_t* mask(Index column) const { return mask_.data() + column * words_; }

  // x := (I - scale v v') x with reflection k.
  template <class Column>
  void reflect(Index k, Column&& x) const;
  void measure_remaining(Index column);
  bool factorize_sparse(const Rows& G, const std::vector<Index>& rows, double tolerance, const Deadline& deadline);
  Index choose(double tolerance);
  void eliminate(Index column);
  void form_null_space(const Deadline& deadline);

  SparseQr sparse_;
  Index n_ = 0, padded_size_ = 0, words_ = 0;
  Matrix V_;                         // padded n x rows: what remains of a row; after its turn, its reflection
  Matrix R_;                         // min(n, rows) x rows, column by row of G_E
  Matrix N_, Nt_;                    // padded n x freedom, not formed when rank = 0; its transpose
  Mask mask_, free_mask_;            // words_ a column: the blocks that may be non-zero
  std::vector<int> crowd_;           // a block: how many open columns have it
  std::vector<Index> open_, order_;  // columns undecided (at the end: rejected) and accepted
  std::vector<Index> pivot_entry_, free_entry_;
  std::vector<char> taken_;
  Vector scale_, norm_;
  double smallest_ = 1;
};

}  // namespace zwang
