#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include <zwang/bench/collision/meshes.h>
#include <zwang/bench/collision/witness.h>
#include <zwang/bench/scenes/physical.h>
#include "tests/collision/placed.h"
#include "tests/recorded_data.h"

namespace zwang {
namespace {

using collision::Mesh;
using collision::Move;
using collision::Shape;
using collision::TimeOfContact;
using collision::tree;
using collision::World;

TEST(Witness, SeesOverlapAndClearance) {
  const auto mesh = tree(meshes::sheet(0.2, 0.2, 200));
  const Witness witness(std::span(&mesh, 1));
  const std::array shapes{Shape::sphere(0.01), Shape::capsule(0.04, 0.01),
                          Shape::rounded_box({0.05, 0.06, 0.02}, 0.004)};
  Draw draw(7);
  for (const Shape& shape : shapes)
    for (int i = 0; i < 50; ++i) {
      Pose<double> pose{{0.01, 0.02, 0}, rotation(draw.cube(3))};
      double lowest = 0;
      for (const Vec3& q : shape.corners()) lowest = std::min(lowest, (pose.rotation * q).z());
      const double contact = shape.radius() - lowest;
      for (const double gap : {2e-5, -2e-5}) {
        pose.position.z() = contact + gap;
        EXPECT_EQ(witness.overlaps(shape, pose, 0, {}), gap < 0) << i;
      }
    }
}

// Exact vertex-face and edge-edge queries of Wang et al. (2021): coordinates as fractions, truth from rational
// arithmetic. Those in which both partners keep their form and attitude (361 of 500) are motions of rigid bodies.
TEST(ExactQueries, NoTrueContactIsMissedAndNoneIsInvented) {
  const std::filesystem::path folder = test::recorded_data() / "ccd_queries";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  constexpr double radius = 1e-6, stop = 1e-6;
  int asked = 0, hits = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".csv") continue;
    const bool faces = entry.path().string().find("vertex-face") != std::string::npos;
    std::ifstream in(entry.path());
    for (;;) {
      std::array<Vec3, 8> p;
      int truth = 0;
      for (Vec3& x : p)
        for (int k = 0; k < 3; ++k) {
          double over = 0, under = 1;  // below 2^53, and a power of two
          char comma;
          in >> over >> comma >> under >> comma;
          x[k] = over / under;
          if (k == 2) in >> truth;
        }
      if (!in) break;
      const std::size_t split = faces ? 1 : 2;
      const auto moved = [&](std::size_t i) { return Vec3(p[i + 4] - p[i]); };
      const auto together = [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i)
          if ((moved(i) - moved(from)).norm() > 1e-12) return false;
        return true;
      };
      if (!together(0, split) || !together(split, 4)) continue;

      World world({.stop = stop});
      const auto add = [&](std::size_t from, std::size_t to) {
        std::vector<Vec3> points;
        for (std::size_t i = from; i < to; ++i) points.push_back(p[i] - p[from]);
        return world.add(Shape::hull(points, radius), {p[from], Mat3::Identity()});
      };
      const int a = add(0, split);
      const int b =
          faces ? world.add(tree(Mesh{{p[1] - p[1], p[2] - p[1], p[3] - p[1]}, {{0, 1, 2}}}), {p[1], Mat3::Identity()})
                : add(2, 4);
      std::array<Move, 2> moves{Move{a}, Move{b}};
      moves[0].twist.head<3>() = moved(0);
      moves[1].twist.head<3>() = moved(split);
      const TimeOfContact toc = world.time_of_contact(moves);
      ++asked;
      hits += truth;
      EXPECT_TRUE(truth == 0 || toc.time < 1) << entry.path() << " query " << asked;
      if (!truth && toc.time < 1) {  // within the radii and the stop distance of it, then
        for (const Move& m : moves)
          world.place(m.collider, retract(world.pose(m.collider), Vec<double, 6>(toc.time * m.twist)));
        ASSERT_FALSE(world.touches(2 * stop).empty());
        EXPECT_LE(world.touches(2 * stop)[0].gap, stop * (1 + 1e-6));
      }
    }
  }
  EXPECT_EQ(asked, 361);
  EXPECT_EQ(hits, 37);
}

}  // namespace
}  // namespace zwang
