#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <zwang/bench/scenes/families.h>
#include <zwang/core/files/problem_file.h>
#include "tests/recorded_data.h"

namespace zwang {
namespace {

// The atlas of problems that the measured figures refer to, where it is at hand.
class SameAsAtlas : public testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path file = test::recorded_data() / "problems/atlas.h5";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
    all = read_problems(file);
  }
  std::vector<Instance> all = {};
};

Instance our_version(const Instance& point) {
  const double knob = point.knob_value;
  const bool both_ways = point.family == "UNIT" || point.family == "ROW";
  const double size = knob == 0 ? zero_knob : std::log2(std::abs(knob)), k = both_ways ? size : std::abs(size);
  const std::string feasible = point.family == "GAP" && knob >= 0 ? ",feasible=1)" : ")";
  if (point.family == "STK") return make_scenes("STK(boxes=" + std::to_string(point.problem.size()) + ")").at(0);
  return make_scenes(point.family + "(k=" + std::to_string(static_cast<int>(k)) + feasible).at(0);
}

TEST_F(SameAsAtlas, FullyDeterminedFamiliesAreTheSameProblems) {
  int compared = 0;
  for (const Instance& point : all) {
    const std::string& f = point.family;
    if (f != "MR" && f != "MR1" && f != "WED" && f != "STK" && f != "LOOP" && f != "GAP" && f != "INC") continue;
    const Instance ours = our_version(point);
    SCOPED_TRACE(point.problem.name + " is " + ours.problem.name);
    EXPECT_EQ(Matrix(ours.problem.M), Matrix(point.problem.M));
    EXPECT_EQ(ours.problem.z_u, point.problem.z_u);
    EXPECT_EQ(ours.problem.c, point.problem.c);
    EXPECT_EQ(ours.problem.kind, point.problem.kind);
    ASSERT_EQ(ours.problem.rows(), point.problem.rows());
    // The four corners of a box may come in another order.
    const Matrix J = ours.problem.J, theirs = point.problem.J;
    const Index block = f == "MR" ? 4 : 1;
    for (Index i = 0; i < J.rows(); ++i) {
      bool found = false;
      for (Index k = i - i % block; k < i - i % block + block; ++k) found = found || J.row(i) == theirs.row(k);
      EXPECT_TRUE(found) << "row " << i;
    }
    ASSERT_EQ(ours.reference->feasible, point.reference->feasible);
    if (ours.reference->feasible) {
      EXPECT_LE((ours.reference->z - point.reference->z).norm(), 1e-15 * point.problem.z_u.norm());
    }
    ++compared;
  }
  EXPECT_EQ(compared, 12 + 12 + 16 + 7 + 17 + 33 + 17);
}

TEST_F(SameAsAtlas, DrawnFamiliesHaveTheSameShape) {
  int compared = 0;
  for (const Instance& point : all) {
    const std::array families = {"NPE", "NPI", "WEAK", "MRC", "UNIT", "ROW", "HUGE", "ANI"};
    if (std::ranges::find(families, point.family) == families.end()) continue;
    const Instance ours = our_version(point);
    SCOPED_TRACE(ours.problem.name);
    EXPECT_EQ(ours.problem.size(), point.problem.size());
    EXPECT_EQ(ours.problem.kind, point.problem.kind);
    if (point.family != "NPE" && point.family != "ANI") {
      EXPECT_EQ(Matrix(ours.problem.M), Matrix(point.problem.M));
    }
    if (ours.reference) {
      EXPECT_EQ(ours.reference->feasible, point.reference->feasible);
    }
    ++compared;
  }
  EXPECT_EQ(compared, 15 + 15 + 14 + 13 + 11 + 21 + 21 + 12);
}

}  // namespace
}  // namespace zwang
