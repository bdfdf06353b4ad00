#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include <zwang/solvers/form/whiten.h>

namespace zwang {

// An earlier frame's multipliers among the rows of this one, found by key.
class WarmRows {
 public:
  // rows: BasicWhitened's or BodyRows' {row, equality, row_norm, rows()}.

  // The inequality rows that carried a positive multiplier, the largest force first.
  template <class P, class Rows>
  const std::vector<Index>& find(const P& problem, const Rows& rows, const WarmStart* warm) {
    found_.clear();
    pushing_.clear();
    if (!warm) return found_;
    key_ = &problem.key;
    Index last = -1, begin = 0;
    // Half of the joints' multipliers are positive, which no branch foresees, but joints stand where they stood.
    const auto is_known_joint = [&](Index k) { return is(warm->key[at(k)], k) && problem.is_equality(k); };
    while (begin < count(*warm) && is_known_joint(begin)) ++begin;
    const auto pushes = [](double lambda) { return lambda > 0; };
    match(rows.row, *warm, begin, pushes, [&](Index place, Index i, double lambda) {
      if (rows.equality[at(i)]) return;
      // Keys that occur twice.
      if (place <= last && std::ranges::find(pushing_, i, &Pushing::second) != pushing_.end()) return;
      last = std::max(last, place);
      pushing_.emplace_back(-lambda * static_cast<double>(rows.row_norm[i]), i);
    });
    std::sort(pushing_.begin(), pushing_.end());
    for (const auto& [force, i] : pushing_) found_.push_back(i);
    return found_;
  }

  // All of them on unit rows: zero where there is none, and not below on inequality rows.
  template <class Rows>
  void multipliers(const Problem& problem, const Rows& rows, const WarmStart* warm, Vector& unit) {
    unit.setZero(rows.rows());
    if (!warm) return;
    key_ = &problem.key;
    const auto counts = [](double lambda) { return lambda != 0; };
    match(rows.row, *warm, 0, counts, [&](Index, Index i, double lambda) {
      const double own = rows.unit_multiplier(i, lambda);
      unit[i] = rows.equality[at(i)] ? own : std::max(0.0, own);
    });
  }

 private:
  using Pushing = std::pair<double, Index>;  // minus the force, row

  static Index count(const WarmStart& warm) {
    return std::min(static_cast<Index>(warm.key.size()), warm.lambda.size());
  }

  // visit(place among the problem's rows, which of `row` that is, lambda) for those from `begin` on that are wanted and
  // still there. Most stand where they stood, or as far from there as the one before.
  template <class Wanted, class Visit>
  void match(const std::vector<Index>& row, const WarmStart& warm, Index begin, Wanted&& wanted, Visit&& visit) {
    searches_ = 0;
    Index shift = 0;
    for (Index k = begin; k < count(warm); ++k) {
      if (!wanted(warm.lambda[k])) continue;
      const Index place = find(warm.key[at(k)], k + shift);
      if (place < 0) continue;
      shift = place - k;
      if (const Index i = row_of(place, row); i >= 0) visit(place, i, warm.lambda[k]);
    }
  }

  // Which of `row`, ascending, is the problem's row `place`, or -1.
  static Index row_of(Index place, const std::vector<Index>& row) {
    const std::size_t same = at(place);
    if (same < row.size() && row[same] == place) return place;
    const auto found = std::ranges::lower_bound(row, place);
    return found != row.end() && *found == place ? found - row.begin() : -1;
  }

  bool is(const RowKey& key, Index i) const { return i >= 0 && i < std::ssize(*key_) && (*key_)[at(i)] == key; }

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
    const auto key_of = [&](Index i) { return (*key_)[at(i)]; };
    if (searches_ == few + 1) {
      order_.resize(key_->size());
      for (Index i = 0; i < std::ssize(*key_); ++i) order_[at(i)] = i;
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
