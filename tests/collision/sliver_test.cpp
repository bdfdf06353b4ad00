#include <gtest/gtest.h>

#include <zwang/bench/collision/meshes.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/collision/halves.h>
#include <zwang/collision/nearest.h>
#include <zwang/collision/world.h>
#include "tests/collision/sliver_parts.h"

namespace zwang::collision {
namespace {

struct Part {
  const char* name;
  Mesh mesh;
};

const std::vector<Part>& parts() {
  static const std::vector<Part> all = [] {
    std::vector<Part> made{{"gear", meshes::sliver_gear(0.031, 0.012, 24, 80, 2, 8e-7)},
                           {"splined shaft", meshes::sliver_gear(0.02, 0.06, 16, 40, 1, 2e-6)},
                           {"thread", meshes::sliver_thread(0.012, 0.003, 6, 12, 60, 3e-7)},
                           {"loft", meshes::sliver_loft(0.04, 0.05, 4000, 1e-4)},
                           {"plate", meshes::sliver_plate({0.15, 0.1, 0.02}, 5000)}};
    const std::size_t count = made.size();
    for (std::size_t k = 0; k < count; ++k) made.push_back({"spoiled", meshes::spoiled(made[k].mesh)});
    return made;
  }();
  return all;
}

// By looking at every triangle.
NearestPoint nearest_of_all(const Tree& tree, const Vec3& p, std::span<const Plane> hidden) {
  NearestPoint best{.distance = 1};
  for (std::uint32_t t = 0; t < tree.size(); ++t) {
    const Vec3 q = nearest_point(tree.triangle(t), p);
    const double distance = (q - p).norm();
    if (distance < best.distance &&
        std::none_of(hidden.begin(), hidden.end(), [&](const Plane& plane) { return plane.hides(q); }))
      best = {distance, q, t};
  }
  return best;
}

// Near the part, whose axis is z, and not the large triangle under a spoiled one.
Pose<double> somewhere(Draw& draw, const Tree& tree) {
  return {Vec3(0, 0, tree.box().center().z()) + 0.06 * draw.cube(1), rotation(draw.cube(2))};
}

TEST(Slivers, AreAsThinAsTheySay) {
  for (std::size_t k = 0; k < 4; ++k) EXPECT_GT(meshes::aspects(parts()[k].mesh).largest, 1e4) << parts()[k].name;
  EXPECT_GT(meshes::aspects(parts()[0].mesh).largest, 1e5);
}

TEST(Slivers, NearestPointIsThatOfAllTriangles) {
  Draw draw(31);
  for (const Part& part : parts()) {
    const Tree tree(part.mesh);
    for (int i = 0; i < 60; ++i) {
      const Vec3 p = somewhere(draw, tree).position;
      const auto found = nearest(tree, p, 1);
      const NearestPoint truth = nearest_of_all(tree, p, {});
      ASSERT_TRUE(found) << part.name;
      ASSERT_NEAR(found->distance, truth.distance, 1e-15) << part.name;
      const Vec3 n = (p - truth.point).normalized();
      const Plane plane{n, n.dot(truth.point)};
      const auto next = nearest(tree, p, 1, std::span(&plane, 1));
      const NearestPoint truth_next = nearest_of_all(tree, p, std::span(&plane, 1));
      ASSERT_EQ(next.has_value(), truth_next.distance < 1) << part.name;
      if (next) {
        ASSERT_NEAR(next->distance, truth_next.distance, 1e-15) << part.name;
      }
    }
  }
}

// No touch says more than is true of any triangle, the nearest says it to a tenth, and the stops are clear.
TEST(Slivers, TouchesAndStopsHoldForEveryTriangle) {
  Draw draw(32);
  for (const Part& part : parts()) {
    const auto tree = std::make_shared<const Tree>(part.mesh);
    for (const Shape& shape :
         {Shape::sphere(0.008), Shape::capsule(0.04, 0.008), Shape::rounded_box({0.08, 0.09, 0.02}, 0.005)}) {
      World world;
      world.add(tree);
      world.add(shape);
      int near = 0;
      for (int i = 0; i < 2000 && near < 5; ++i) {
        world.place(1, somewhere(draw, *tree));
        const auto true_gap = [&] {
          double least = 1;
          for (const Triangle& t : tree->triangles())
            least = std::min(least, closest(shape, world.pose(1), {.triangle = &t}, 1).distance - shape.radius());
          return least;
        };
        double least = 0.005;
        for (const Touch& t : world.touches(0.005)) {
          least = std::min(least, t.gap);
          ASSERT_LT((t.point_a - t.point_b - t.gap * t.normal).norm(), 1e-12);
        }
        if (least >= 0.005 || least <= 1e-6) continue;
        ++near;
        const double truth = true_gap();
        ASSERT_LE(least, truth + 1e-12) << part.name;
        ASSERT_GE(least, truth - 0.1 * (truth + 1e-4) - 1e-12) << part.name;
        Move move{.collider = 1};
        move.twist << 0.01 * draw.direction(), draw.cube(0.1);
        const double time = world.time_of_contact({&move, 1}).time;
        world.place(1, retract(world.pose(1), Vec<double, 6>(time * move.twist)));
        ASSERT_GT(true_gap(), std::min(4e-5, truth / 2)) << part.name;
      }
      EXPECT_GT(near, 0) << part.name;
    }
  }
}

// A point over a face of slivers that run across the axes has hundreds of their boxes along the axes above it.
TEST(Slivers, AreTreatedInTreesOfTheirOwnAndAllocateNothing) {
  const Mesh gear = meshes::sliver_gear(0.031, 0.012, 24, 80, 2, 8e-7);
  EXPECT_TRUE(mostly_slivers(gear));
  EXPECT_FALSE(mostly_slivers(meshes::gear(0.031, 0.012, 24, 20000)));
  const auto tree = std::make_shared<const Tree>(gear);
  std::size_t oblique = 0;
  for (std::size_t k = 0; k < tree->nodes().size(); ++k) {
    const Slab* slab = tree->slab(k);
    if (slab == nullptr) continue;
    ++oblique;
    const auto [begin, end] = tree->range(k);
    for (const Vec3& p : tree->points(begin, end)) ASSERT_EQ(slab->distance2(p), 0);
  }
  EXPECT_GT(oblique, tree->size() / 10);
  World world;
  world.add(tree);
  world.add(Shape::capsule(0.04, 0.008), {Vec3(0.02, 0, 0.0121 + 0.008), Mat3::Identity()});
  const std::size_t touches = world.touches(2e-3).size();
  world.place(1, world.pose(1));
  const long before = allocations();
  EXPECT_EQ(world.touches(2e-3).size(), touches);
  EXPECT_TRUE(nearest(*tree, world.pose(1).position, 0.01));
  EXPECT_EQ(allocations(), before);
}

// A face of strips is a few planes to a finger, whichever way the strips run and however many they are.
TEST(Slivers, OfAFaceCountAsOneWhereOnePlaneKeepsThemOff) {
  for (const auto& [strips, turn] : {std::pair(5000, 0.0), std::pair(5000, 0.4), std::pair(20000, 0.4)}) {
    const auto tree = std::make_shared<const Tree>(meshes::sliver_plate({0.15, 0.1, 0.02}, strips));
    const Pose<double> place{Vec3::Zero(), rotation(Vec3(0, 0, turn))};
    World world;
    world.add(tree, place);
    world.add(Shape::capsule(0.04, 0.008), {place * Vec3(0.01, 0.01, 0.028 + 5e-4), place.rotation});
    const auto touches = world.touches(2e-3);
    std::size_t near = 0;
    for (const Triangle& t : tree->triangles())
      near +=
          closest(*world.shape(1), {Vec3(0.01, 0.01, 0.028 + 5e-4), Mat3::Identity()}, {.triangle = &t}, 1).distance <
          0.01;
    EXPECT_GT(near, 100);
    EXPECT_GT(touches.size(), 0);
    EXPECT_LT(touches.size(), 30);
    double least = 1;
    for (const Touch& t : touches) least = std::min(least, t.gap);
    EXPECT_LE(least, 5e-4 + 1e-12);
    EXPECT_GE(least, 5e-4 - 0.1 * (5e-4 + 1e-4));
  }
}

TEST(Slivers, ATreeFromItsBytesAnswersTheSame) {
  Draw draw(33);
  const Tree tree(parts()[0].mesh), restored = Tree::from_bytes(tree.to_bytes());
  for (int i = 0; i < 20; ++i) {
    const Vec3 p = somewhere(draw, tree).position;
    EXPECT_EQ(nearest(tree, p, 1)->distance, nearest(restored, p, 1)->distance);
  }
  EXPECT_EQ(tree.bytes_per_triangle(), restored.bytes_per_triangle());
}

}  // namespace
}  // namespace zwang::collision
