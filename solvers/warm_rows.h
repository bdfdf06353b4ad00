#pragma once

#include <algorithm>
#include <vector>

#include "solvers/whiten.h"

namespace zwang {

// The inequality rows that carried a positive multiplier in an earlier frame, found by key, the largest force first.
class WarmRows {
 public:
  // rows: BasicWhitened's or BodyRows' {row, equality, row_norm, rows()}.
  template <class Rows>
  const std::vector<Index>& find(const Problem& problem, const Rows& rows, const WarmStart* warm) {
    found_.clear();
    force_.clear();
    if (!warm) return found_;
    const std::size_t count = std::min(warm->key.size(), static_cast<std::size_t>(warm->lambda.size()));
    order_.clear();
    for (std::size_t i = 0; i < count; ++i)
      if (warm->lambda[static_cast<Index>(i)] > 0) order_.push_back(i);
    std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return warm->key[a] < warm->key[b]; });
    force_.resize(static_cast<std::size_t>(rows.rows()));
    for (Index i = 0; i < rows.rows(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (rows.equality[at]) continue;
      const RowKey& key = problem.key[static_cast<std::size_t>(rows.row[at])];
      const auto place = std::lower_bound(order_.begin(), order_.end(), key,
                                          [&](std::size_t a, const RowKey& k) { return warm->key[a] < k; });
      if (place == order_.end() || warm->key[*place] != key) continue;
      force_[at] = warm->lambda[static_cast<Index>(*place)] * rows.row_norm[i];
      found_.push_back(i);
    }
    std::sort(found_.begin(), found_.end(), [&](Index a, Index b) {
      const double x = force_[static_cast<std::size_t>(a)], y = force_[static_cast<std::size_t>(b)];
      return x > y || (x == y && a < b);
    });
    return found_;
  }

 private:
  std::vector<std::size_t> order_;
  std::vector<Index> found_;
  std::vector<double> force_;
};

}  // namespace zwang
