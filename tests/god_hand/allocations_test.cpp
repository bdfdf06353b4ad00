#include <zwang/bench/timing/allocations.h>

#include <gtest/gtest.h>

#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/god_hand/step/physics.h>
#include "tests/god_hand/tracked.h"

namespace zwang::god {
namespace {

// Heap blocks a frame, of the second of two rounds of a hand that goes up and down about the focus and opens and
// closes; `depth`: how far that takes it.
double per_frame(const Surroundings& s, double high, double depth) {
  Simulation simulation = one_hand(s, hand_at(posed(s.focus.x(), s.focus.y() - 0.1, high)));
  long blocks = 0;
  constexpr int frames = 315;
  for (int round = 0; round < 2; ++round) {
    blocks = -allocations();
    for (int k = 0; k < frames; ++k) {
      const double part = 0.5 - 0.5 * std::cos(0.02 * k);
      const Frame& f = go(simulation, hand_at(posed(s.focus.x(), s.focus.y() - 0.1, high - depth * part), 0.4 * part));
      EXPECT_GT(f.kept, 0);
    }
    blocks += allocations();
  }
  return static_cast<double>(blocks) / frames;
}

Surroundings floor() {
  Surroundings s{.name = "floor"};
  s.objects.push_back(fixed(meshes::plate({1, 1, 0.1}, 5000), {{0, 0, -0.05}, Mat3::Identity()}));
  return s;
}

TEST(Allocations, NoneWhileTheRowsAreAsMany) {
  Simulation simulation = one_hand(floor(), hand_at(posed(0, 0, 0.05)));
  for (int k = 0; k < 300; ++k) go(simulation, hand_at(posed(0, 0, std::max(0.0, 0.05 - 2e-4 * k)), 0.1));
  long blocks = 0;
  int same = 0, rows = 0;
  for (int k = 0; k < 300; ++k) {
    const long before = allocations();
    const Frame& f = go(simulation, hand_at(posed(1e-5 * k, 0, 0), 0.1));
    if (f.rows == rows) blocks += allocations() - before, ++same;
    rows = f.rows;
  }
  EXPECT_GT(same, 250);
  EXPECT_EQ(blocks, 0);
}

// Vectors of Eigen have no room to grow: with another number of rows those of the problem and of the solution are new.
TEST(Allocations, FewWhereTheRowsChange) {
  for (const auto& [s, depth] : {std::pair(floor(), 0.1), std::pair(make_surroundings("pegs", ""), 0.1),
                                 std::pair(make_surroundings("simple", ""), 0.1)}) {
    const double blocks = per_frame(s, 0.06, depth);
    RecordProperty(s.name, std::to_string(blocks));
    EXPECT_LT(blocks, 25) << s.name;
  }
}

TEST(Allocations, NoneByTheEngine) {
  const Surroundings s = make_surroundings("simple", "");
  Physics physics(s);
  const std::vector<Vec<double, 6>> nothing(s.objects.size(), Vec<double, 6>::Zero());
  for (int k = 0; k < 300; ++k) physics.step(1e-3, nothing);
  const long before = allocations();
  for (int k = 0; k < 300; ++k) physics.step(1e-3, nothing);
  EXPECT_EQ(allocations() - before, 0);
}

}  // namespace
}  // namespace zwang::god
