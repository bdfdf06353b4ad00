#include <zwang/solvers/factor/row_lanes.h>

#include <zwang/solvers/linalg/lanes.h>

namespace zwang {

using lanes::at;
using lanes::width;

void RowLanes::reset(Index size, Index room) {
  size_ = size;
  const Index most = lanes::round_up(room) / width * size;
  if (entries_.cols() < most) entries_.resize(width, most + 1);
  column_.reserve(at(most));
  start_.reserve(at(lanes::round_up(room) / width + 1));
  start_.assign(1, 0);
}

void RowLanes::take(const lanes::Columns& At, Index known, Index rows) {
  const Index first = known / width;
  start_.resize(at(first) + 1);
  Index used = start_.back();
  column_.resize(at(entries_.cols()));
  for (Index begin = first * width; begin < rows; begin += width) {
    const Index count = std::min(width, rows - begin);
    for (Index k = 0; k < size_; k += width) {
      std::array<lanes::Pack, width> block;
      for (Index l = 0; l < width; ++l)
        block[at(l)] = l < count ? lanes::Pack::load(&At(k, begin + l)) : lanes::Pack(0);
      lanes::transpose(block);
      for (Index c = 0; c < std::min(width, size_ - k); ++c) {
        block[at(c)].store(entries_.col(used).data());
        column_[at(used)] = static_cast<int>(k + c);
        used += (entries_.col(used).array() != 0).any();
      }
    }
    start_.push_back(used);
  }
}

void RowLanes::accumulate(double scale, const double* x, double* y) const {
  using packets::all;
  using packets::load;
  using packets::Packet;
  constexpr Index count = width / packets::width;
  const double* entry = entries_.data();
  const int* column = column_.data();
  for (std::size_t k = 1; k < start_.size(); ++k, y += width) {
    Packet even[count], odd[count];
    for (Index v = 0; v < count; ++v) even[v] = odd[v] = all(0);
    Index left = start_[k] - start_[k - 1];
    for (; left > 1; left -= 2, column += 2, entry += 2 * width) {
      const Packet first = all(x[column[0]]), second = all(x[column[1]]);
      for (Index v = 0; v < count; ++v) {
        even[v] = packets::multiply_add(first, load(entry + v * packets::width), even[v]);
        odd[v] = packets::multiply_add(second, load(entry + width + v * packets::width), odd[v]);
      }
    }
    if (left > 0) {
      const Packet own = all(x[*column++]);
      for (Index v = 0; v < count; ++v) even[v] = packets::multiply_add(own, load(entry + v * packets::width), even[v]);
      entry += width;
    }
    for (Index v = 0; v < count; ++v) {
      double* const to = y + v * packets::width;
      packets::store(to, packets::multiply_add(all(scale), even[v] + odd[v], load(to)));
    }
  }
}

}  // namespace zwang
