#pragma once

#include <span>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/core/problem/sparsity_pattern.h>
#include <zwang/solvers/linalg/dense_storage.h>

namespace zwang {

// Sparse rows g_i over the columns of a matrix, one after another.
struct SparseRows {
  std::vector<int> begin = {0};  // rows + 1
  std::vector<int> column = {};
  std::vector<double> value = {};

  int rows() const { return static_cast<int>(begin.size()) - 1; }
  bool operator==(const SparseRows&) const = default;
};

struct MatrixEntry {
  int row, column;
  double value;
};

// y := M x
inline void multiply(const std::vector<MatrixEntry>& M, const Vector& x, Vector& y) {
  y.setZero();
  for (const MatrixEntry& e : M) y[e.row] += e.value * x[e.column];
}

// H = M + sum of weight_i g_i g_i' = L L', factorized by fronts (Duff & Reid 1983, ACM TOMS 9), for rows that come and
// go: the symbolic part covers all rows and is kept while the patterns of M and of the rows stay, and a front is
// factorized again only when a row of its own, or of a front below it, has changed.
//
// Columns are taken in groups of six, a body each, less those that no row and no coupling in M touches ("loose"; a
// stored zero couples nothing): a wall whose contacts are all level is then a system in three unknowns a brick. Groups
// are ordered by minimum degree.
class BlockCholesky {
 public:
  // The symbolic part, unless it is there already. Columns are those of M. Throws Stopped where the fronts, or the
  // pairs of columns that the rows couple, do not fit, or the time is over. The first 3 `triples` rows come in threes
  // of one pattern, which are added at once.
  void analyze(const SparseMatrix& M, const SparseRows& rows, const SolveOptions& options = {},
               const Deadline& deadline = Deadline(), int triples = 0);

  int size() const { return static_cast<int>(column_.size()); }     // columns that are not loose
  int column(int position) const { return column_[at(position)]; }  // elimination order -> column of M
  int position(int column) const { return position_[at(column)]; }  // and back; -1: loose
  int parts() const { return parts_; }                              // H decomposes into that many diagonal blocks
  int part_of_row(int row) const { return part_[at(front_of_row_[at(row)])]; }
  int part_of_position(int position) const { return part_[at(front_of_[at(position)])]; }
  // By position: M, both triangles, and the column of every entry of the rows.
  void list(const SparseMatrix& M, const SparseRows& rows, std::vector<MatrixEntry>& entries,
            std::vector<int>& place) const;
  long fill() const { return static_cast<long>(panel_.size()); }

  // Forgets the factor: values of M or of the rows have changed.
  void invalidate() { valid_ = false; }
  // weight: of each row, 0 for a row that is out. False on a pivot that is not positive, and past the deadline.
  bool factorize(const SparseMatrix& M, const SparseRows& rows, std::span<const double> weight,
                 const Deadline& deadline = Deadline());
  // x := H^-1 x, by position.
  void solve(Vector& x) const;

 private:
  struct Front {
    int first = 0, own = 0, size = 0;  // own columns first .. first + own - 1, then size - own rows
    Index stride = 0;
    int parent = -1;
    std::size_t index = 0;                     // into index_ and into_parent_: the rows that it does not own
    std::size_t panel = 0, rest = 0;           // into panel_ (stride x own) and rest_ (its Schur complement, packed)
    std::size_t child = 0, row = 0, mass = 0;  // where its lists begin
  };
  struct MassEntry {
    int row, column, from;  // local row and column, and where it stands in M
  };

  bool find_tied(const SparseMatrix& M, const SparseRows& rows);
  void group_columns();
  void build_fronts(const SparseMatrix& M, const SparseRows& rows, const SolveOptions& options,
                    const Deadline& deadline);
  bool factorize(std::size_t f, const SparseMatrix& M, const SparseRows& rows, std::span<const double> weight,
                 const Deadline& deadline);

  DenseStorage storage_;
  SparsityPattern M_places_;  // patterns at the last analyze()
  std::vector<int> row_begin_, row_column_;

  std::vector<int> column_, position_, group_of_;  // group_of_: column of M -> group, -1: loose
  std::vector<int> group_begin_;
  std::vector<Front> front_;
  std::vector<int> index_, into_parent_, child_, row_list_, front_of_, front_of_row_, part_;
  std::vector<int> local_;  // of every entry of the rows: its row in the front
  std::vector<MassEntry> mass_;
  std::vector<double> panel_, rest_, work_, scratch_, weight_;
  std::vector<char> dirty_, tied_, tied_before_;
  mutable std::vector<double> gathered_;
  int parts_ = 0, triples_ = 0;
  bool valid_ = false;
};

}  // namespace zwang
