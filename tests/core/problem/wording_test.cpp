#include <zwang/core/problem/wording.h>

#include <gtest/gtest.h>

namespace zwang {

TEST(Nearest, OffersTheClosestName) {
  EXPECT_EQ(did_you_mean("towr", {"hand", "tower", "wall"}), "; did you mean 'tower'?");
}

TEST(Nearest, StaysSilentWhenNothingIsClose) {
  EXPECT_EQ(did_you_mean("xyzzy", {"hand", "tower"}), "");
  EXPECT_EQ(did_you_mean("nosuch", {"docs", "lock"}), "");
  EXPECT_EQ(did_you_mean("FOO", {"LOOP"}), "");
  EXPECT_EQ(did_you_mean("conformence", {"conformance"}), "; did you mean 'conformance'?");
}

}  // namespace zwang
