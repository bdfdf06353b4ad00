#pragma once

#include <algorithm>
#include <vector>

#include <zwang/core/problem/problem.h>

namespace zwang {

// Writes down the rows of a problem one after the other.
class RowWriter {
 public:
  Index rows() const { return static_cast<Index>(c_.size()); }

  // The next row, without entries yet. mu: of a contact whose tangent rows follow.
  void add(RowKind kind, RowKey key, double c, double mu = 0) {
    kind_.push_back(kind);
    key_.push_back(key);
    c_.push_back(c);
    mu_.push_back(mu);
  }
  // Into the row that was added last; entries of one place sum.
  void entry(Index column, double value) {
    entries_.emplace_back(static_cast<int>(rows()) - 1, static_cast<int>(column), value);
  }
  // Those of a dense row that are not zero.
  void entries(const Vector& row) {
    for (Index j = 0; j < row.size(); ++j)
      if (row[j] != 0) entry(j, row[j]);
  }
  // Those of a sparse matrix' row (or column, as it is stored), times a factor.
  template <class Sparse>
  void entries(const Sparse& matrix, Index outer, double factor = 1) {
    for (typename Sparse::InnerIterator it(matrix, outer); it; ++it) entry(it.index(), factor * it.value());
  }

  // J, c, kind and key of a problem whose z_u is there, and mu where there are tangent rows.
  void write(Problem& p) const {
    p.kind = kind_;
    p.key = key_;
    p.c = Eigen::Map<const Vector>(c_.data(), rows());
    if (std::ranges::find(kind_, RowKind::tangent) != kind_.end()) p.mu = Eigen::Map<const Vector>(mu_.data(), rows());
    p.J = sparse_of<RowMatrix>(rows(), p.size(), entries_);
  }

 private:
  std::vector<Eigen::Triplet<double>> entries_ = {};
  std::vector<double> c_ = {}, mu_ = {};
  std::vector<RowKind> kind_ = {};
  std::vector<RowKey> key_ = {};
};

}  // namespace zwang
