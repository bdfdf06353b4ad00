#pragma once

#include <cstdint>

#include <zwang/solvers/factor/cone_face.h>
#include <zwang/solvers/factor/row_lanes.h>

namespace zwang {

// Rows of few unknowns, M = I: the freedoms of a hand, a local problem of the literature. Rows are columns padded to
// whole vectors; I + G'DG is summed in tiles that stay in registers, where rows have entries, and factorized by
// Cholesky, or by LU with row exchanges where D is not symmetric.
class DenseFace final : public ConeFace {
 public:
  // Zero rows; allocates only to grow.
  void reset(Index size, Index cones, Index rays);
  void rows_are_set();                               // once all are filled in
  double* row(Index r) { return G_.col(r).data(); }  // padded() entries, zeros behind size
  Index padded() const { return padded_; }

  Index unknowns() const override { return padded_; }
  void slack(const Vector& v, Vector& s) const override;
  void force(const Vector& l, Vector& f) const override;
  void mass(const Vector& v, Vector& f) const override { f = v; }
  bool takes_unsymmetric() const override { return true; }
  bool factorize(const std::vector<double>& D, const Vector& ray_weight, bool symmetric) override;
  void solve(Vector& x) override;
  bool divide_rows() override { return true; }
  double along(Index r, const Vector& v) const override;
  void push(Index r, double l, Vector& v) const override;
  double delassus(Index r, Index q) const override;

 private:
  // A contact's three rows, or a single one, and a bit for each part of the unknowns where they have entries.
  struct Item {
    Index row = 0, rows = 0;
    std::uint64_t parts = 0;
  };
  void find_parts(std::uint64_t parts);
  Index pack(const Item& item, const std::vector<double>& D, const Vector& ray_weight, Index count);
  bool cholesky();
  bool lu();
  Index largest_free(const double* column) const;
  void solve_lu(Vector& x);
  void update(const lanes::Columns& L, Index begin, Index end, bool lower);

  Index size_ = 0, padded_ = 0, cones_ = 0, rays_ = 0, rows_ = 0;
  lanes::Columns G_, A_, DG_, H_, across_;  // A_, DG_: of some rows of the same parts
  std::vector<Item> items_;
  std::vector<Index> vectors_, tiles_;
  Index step_ = 1;  // unknowns of a part
  RowLanes lanes_;
  mutable Vector slack_;   // up to whole lanes
  Vector reciprocal_;      // of the pivots
  lanes::Columns L_;       // of LU; U is H_
  Vector free_, ordered_;  // 1: a row that was no pivot yet; a solution in the order of the pivots
  std::vector<Index> pivot_;
  bool symmetric_ = true;
};

}  // namespace zwang
