#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include <zwang/solvers/common/whiten.h>

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
    key_ = &problem.key;
    searches_ = 0;
    Index last = -1;
    Index shift = 0;  // most rows stand where they stood, or as far from there as the row before
    const auto count = std::min(static_cast<Index>(warm->key.size()), warm->lambda.size());
    // Half of the joints' multipliers are positive, which no branch foresees, but joints stand where they stood.
    Index k = 0;
    while (k < count && is(warm->key[static_cast<std::size_t>(k)], k) && problem.is_equality(k)) ++k;
    for (; k < count; ++k) {
      if (!(warm->lambda[k] > 0)) continue;
      const Index place = find(warm->key[static_cast<std::size_t>(k)], k + shift);
      if (place < 0) continue;
      shift = place - k;
      const Index i = row_of(place, rows.row);
      if (i < 0 || rows.equality[static_cast<std::size_t>(i)]) continue;
      // Keys that occur twice.
      if (place <= last && std::ranges::find(pushing_, i, &Pushing::second) != pushing_.end()) continue;
      last = std::max(last, place);
      pushing_.emplace_back(-warm->lambda[k] * rows.row_norm[i], i);
    }
    std::sort(pushing_.begin(), pushing_.end());
    for (const auto& [force, i] : pushing_) found_.push_back(i);
    return found_;
  }

 private:
  using Pushing = std::pair<double, Index>;  // minus the force, row

  // Which of `row`, ascending, is the problem's row `place`, or -1.
  static Index row_of(Index place, const std::vector<Index>& row) {
    const auto at = static_cast<std::size_t>(place);
    if (at < row.size() && row[at] == place) return place;
    const auto found = std::ranges::lower_bound(row, place);
    return found != row.end() && *found == place ? found - row.begin() : -1;
  }

  bool is(const RowKey& key, Index i) const {
    return i >= 0 && i < std::ssize(*key_) && (*key_)[static_cast<std::size_t>(i)] == key;
  }

  // Where the key is among the problem's, first near `guess`, or -1. A few are looked for row by row, more in order.
  Index find(const RowKey& key, Index guess) {
    constexpr Index near = 3;
    constexpr int few = 16;
    if (is(key, guess)) return guess;
    for (Index d = 1; d <= near; ++d)
      for (const Index i : {guess + d, guess - d})
        if (is(key, i)) return i;
    if (++searches_ <= few) {
      const auto place = std::ranges::find(*key_, key);
      return place != key_->end() ? place - key_->begin() : -1;
    }
    const auto key_of = [&](Index i) { return (*key_)[static_cast<std::size_t>(i)]; };
    if (searches_ == few + 1) {
      order_.resize(key_->size());
      for (Index i = 0; i < std::ssize(*key_); ++i) order_[static_cast<std::size_t>(i)] = i;
      std::ranges::sort(order_, {}, key_of);
    }
    const auto place = std::ranges::lower_bound(order_, key, {}, key_of);
    return place != order_.end() && key_of(*place) == key ? *place : -1;
  }

  const std::vector<RowKey>* key_ = nullptr;
  int searches_ = 0;  // keys that were not near their guess
  std::vector<Index> order_, found_;
  std::vector<Pushing> pushing_;
};

}  // namespace zwang
