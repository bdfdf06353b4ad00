#include <gtest/gtest.h>

#include <random>

#include <zwang/collision/broad_phase.h>

namespace zwang::collision {
namespace {

// Boxes that drift, jump, grow and shrink, on a grid of 1/64 so that many only touch: a query meets what a look at all
// boxes meets.
TEST(BroadPhase, MeetsWhatALookAtAllBoxesMeets) {
  std::mt19937 random(1);
  const auto draw = [&](int low, int high) {
    const auto one = [&] { return std::uniform_int_distribution(low, high)(random) / 64.0; };
    return Vec3(one(), one(), one());
  };
  struct Box {
    Vec3 low, high;
  };
  const auto drawn = [&] {
    const Vec3 low = draw(-64, 64);
    return Box{low, low + draw(0, 32)};
  };
  std::vector<Box> boxes;
  BroadPhase tree;
  for (int k = 0; k < 40; ++k) {
    boxes.push_back(drawn());
    tree.add(boxes.back().low, boxes.back().high);
  }
  long hits = 0;
  std::vector<int> met, expected;
  for (int frame = 0; frame < 500; ++frame) {
    for (std::size_t k = 0; k < boxes.size(); ++k) {
      Box& box = boxes[k];
      if (frame % 50 == static_cast<int>(k)) {
        box = drawn();
      } else {
        const Vec3 way = draw(-1, 1);
        box = {box.low + way, box.high + way};
      }
      tree.move(static_cast<int>(k), box.low, box.high);
    }
    const Box asked = drawn();
    tree.query(asked.low, asked.high, met);
    expected.clear();
    for (std::size_t k = 0; k < boxes.size(); ++k)
      if ((boxes[k].low.array() <= asked.high.array()).all() && (boxes[k].high.array() >= asked.low.array()).all())
        expected.push_back(static_cast<int>(k));
    EXPECT_EQ(met, expected) << frame;
    hits += std::ssize(met);
  }
  EXPECT_GT(hits, 200);
}

}  // namespace
}  // namespace zwang::collision
