#include <zwang/core/problem/shape_cache.h>

#include <gtest/gtest.h>

namespace zwang {
namespace {

TEST(ShapeCache, KeepsOneForEachShapeOfAProblem) {
  ShapeCache<int> stored;
  for (int again = 0; again < 2; ++again) {
    stored.begin();
    int &a = stored.of(6, 1), &b = stored.of(6, 2), &c = stored.of(12, 1);
    if (again == 0) a = 1, b = 2, c = 3;
    EXPECT_EQ(stored.of(6, 1), 1);
    EXPECT_EQ(stored.of(6, 2), 2);
    EXPECT_EQ(stored.of(12, 1), 3);
    EXPECT_EQ(&stored.of(6, 1), &a);
  }
}

TEST(ShapeCache, GivesTheLongestUnusedToAnotherShape) {
  ShapeCache<int> stored;
  stored.begin();
  stored.of(6, 1) = 1;
  stored.of(6, 2) = 2;
  stored.of(6, 1);
  stored.begin();
  EXPECT_EQ(stored.of(6, 3), 2);
  EXPECT_EQ(stored.of(6, 1), 1);
  EXPECT_EQ(stored.of(6, 4), 0) << "all are in use";
}

TEST(ShapeCache, KeepsUnusedOnesWhereAsked) {
  ShapeCache<int> stored(3);
  for (int k = 1; k <= 3; ++k) {
    stored.begin();
    stored.of(k, 0) = k;
  }
  stored.begin();
  EXPECT_EQ(stored.of(1, 0), 1);
  EXPECT_EQ(stored.of(2, 0), 2);
  stored.begin();
  EXPECT_EQ(stored.of(4, 0), 3);
}

}  // namespace
}  // namespace zwang
