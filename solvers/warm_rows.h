#pragma once

#include <algorithm>
#include <utility>
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
    pushing_.clear();
    if (!warm) return found_;
    warm_ = warm;
    sorted_ = false;
    Index shift = 0;  // most rows stand where they stood, or as far from there as the row before
    for (Index i = 0; i < rows.rows(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (rows.equality[at]) continue;
      const Index place = find(problem.key[static_cast<std::size_t>(rows.row[at])], rows.row[at] + shift);
      if (place < 0) continue;
      shift = place - rows.row[at];
      if (!(warm->lambda[place] > 0)) continue;
      pushing_.emplace_back(-warm->lambda[place] * rows.row_norm[i], i);
    }
    std::sort(pushing_.begin(), pushing_.end());
    for (const auto& [force, i] : pushing_) found_.push_back(i);
    return found_;
  }

 private:
  // Where the key is among the earlier frame's, first near `guess`, or -1; far from it only pushing rows are found.
  Index find(const RowKey& key, Index guess) {
    constexpr Index near = 3;
    const auto count = std::min(static_cast<Index>(warm_->key.size()), warm_->lambda.size());
    const auto is = [&](Index k) { return k >= 0 && k < count && warm_->key[static_cast<std::size_t>(k)] == key; };
    if (is(guess)) return guess;
    for (Index d = 1; d <= near; ++d)
      for (const Index k : {guess + d, guess - d})
        if (is(k)) return k;
    if (!sorted_) {
      order_.clear();
      for (Index k = 0; k < count; ++k)
        if (warm_->lambda[k] > 0) order_.push_back(static_cast<std::size_t>(k));
      std::sort(order_.begin(), order_.end(),
                [&](std::size_t a, std::size_t b) { return warm_->key[a] < warm_->key[b]; });
      sorted_ = true;
    }
    const auto place = std::lower_bound(order_.begin(), order_.end(), key,
                                        [&](std::size_t a, const RowKey& k) { return warm_->key[a] < k; });
    return place != order_.end() && warm_->key[*place] == key ? static_cast<Index>(*place) : -1;
  }

  const WarmStart* warm_ = nullptr;
  bool sorted_ = false;
  std::vector<std::size_t> order_;
  std::vector<Index> found_;
  std::vector<std::pair<double, Index>> pushing_;  // minus the force, row
};

}  // namespace zwang
