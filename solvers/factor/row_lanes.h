#pragma once

#include <vector>

#include <zwang/solvers/linalg/line_matrix.h>

namespace zwang {

// The rows of a matrix in eights, one a lane; of each eight only the columns in which one of them has an entry. A
// contact of a hand meets the unknowns of the palm and of its own finger, 10 of 26, and its neighbours the same ones.
class RowLanes {
 public:
  // No rows, and room for `room` of `size` entries; allocates only to grow.
  void reset(Index size, Index room);
  // The rows are now the first `rows` columns of `At`, filled up to whole lanes by zeros. Those up to `known` have not
  // changed since the last time.
  void take(const lanes::Columns& At, Index known, Index rows);

  // y += scale A x over all lanes.
  void accumulate(double scale, const double* x, double* y) const;

 private:
  Index size_ = 0;
  std::vector<Index> start_;  // of an eight, in column_
  std::vector<int> column_;
  lanes::Columns entries_;  // eight lanes x as many as column_
};

}  // namespace zwang
