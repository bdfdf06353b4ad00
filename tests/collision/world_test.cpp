#include <zwang/collision/world.h>

#include <gtest/gtest.h>

#include <cstring>

#include <zwang/bench/collision/meshes.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/collision/manifold.h>
#include "tests/collision/placed.h"

namespace zwang::collision {
namespace {

// The gap by looking at every triangle.
double true_gap(const Shape& shape, const Pose<double>& pose, const Tree& mesh, const Pose<double>& of_mesh) {
  const Pose<double> in_mesh{of_mesh.rotation.transpose() * (pose.position - of_mesh.position),
                             of_mesh.rotation.transpose() * pose.rotation};
  double least = 1;
  for (const Triangle& t : mesh.triangles())
    least = std::min(least, closest(shape, in_mesh, {.triangle = &t}, 1).distance - shape.radius());
  return least;
}

TEST(Touches, FindTheSmallestGapAndItsNormal) {
  Draw draw(6);
  const auto mesh = tree(meshes::gear(0.05, 0.02, 12, 20000));
  const std::array shapes{Shape::sphere(0.008), Shape::capsule(0.05, 0.008),
                          Shape::rounded_box({0.08, 0.09, 0.02}, 0.005),
                          Shape::hull(std::array{Vec3(0.02, 0, 0), Vec3(-0.02, 0.01, 0), Vec3(0, 0, 0.03)}, 0.006)};
  int near = 0;
  for (int i = 0; i < 400; ++i) {
    const Shape& shape = shapes[static_cast<std::size_t>(i % 4)];
    World world;
    const Pose<double> of_mesh = at(draw.cube(0.02), draw.cube(1));
    world.add(mesh, of_mesh);
    world.add(shape, at(draw.uniform(0.04, 0.08) * draw.direction(), draw.cube(2)));
    const double truth = true_gap(shape, world.pose(1), *mesh, of_mesh);
    double least = 1;
    for (const Touch& t : world.touches(0.005)) {
      EXPECT_LE(t.gap, 0.005);
      EXPECT_NEAR(t.normal.norm(), 1, 1e-12);
      EXPECT_LT((t.point_a - t.point_b - t.gap * t.normal).norm(), 1e-12) << "from b to a";
      least = std::min(least, t.gap);
    }
    if (truth > 0.005 || truth < 0) continue;
    ++near;
    EXPECT_LE(least, truth + 1e-12) << i;
    EXPECT_GE(least, truth - 0.1 * (truth + 1e-4) - 1e-12) << i;
  }
  EXPECT_GT(near, 30);
}

TEST(Touches, MasksKeepPairsApart) {
  World world;
  world.add(Shape::sphere(0.01), at({0, 0, 0}), {.group = 1, .mask = ~std::uint64_t{2}});
  world.add(Shape::sphere(0.01), at({0.021, 0, 0}), {.group = 2});
  world.add(Shape::sphere(0.01), at({-0.021, 0, 0}), {.group = 4});
  const auto touches = world.touches(0.005);
  ASSERT_EQ(touches.size(), 1u);
  EXPECT_EQ(touches[0].a, 0);
  EXPECT_EQ(touches[0].b, 2);
  EXPECT_NEAR(touches[0].gap, 0.001, 1e-12);
  EXPECT_NEAR(touches[0].normal.x(), 1, 1e-9);
}

TEST(Touches, SceneryIsNotLookedAtAgainstScenery) {
  World world;
  world.add(tree(meshes::box({0.1, 0.1, 0.1})));
  world.add(Shape::sphere(0.01), at({0, 0, 0.0605}), {}, true);
  EXPECT_TRUE(world.touches(0.01).empty());
  world.add(Shape::sphere(0.01), at({0.0205, 0, 0.0605}));
  for (const Touch& t : world.touches(0.001)) EXPECT_FALSE(t.a == 1 && t.b == 0);
  EXPECT_EQ(world.touches(0.001).front().b, 2) << "what moves meets both";
  EXPECT_EQ(world.touches(0.001).back().b, 0);
}

TEST(World, RefusesWhatItCannotAnswer) {
  World world;
  world.add(Shape::sphere(0.01));
  const Move nobody{.collider = 3};
  EXPECT_THROW(world.time_of_contact({&nobody, 1}), std::invalid_argument);
  Move nan{.collider = 0};
  nan.twist[2] = std::nan("");
  EXPECT_THROW(world.time_of_contact({&nan, 1}), std::invalid_argument);
  EXPECT_THROW(world.add(std::make_shared<const Tree>()), std::invalid_argument);
}

// Frames of a pressed and dragged palm; `look` is called with each.
template <class Look>
void drag_palm(World& world, int frames, Look look) {
  const auto mesh = tree(meshes::bumpy_sphere(0.1, 0.004, 8, 20000));
  world.add(mesh);
  const int palm = world.add(Shape::rounded_box({0.08, 0.09, 0.02}, 0.005), at({0, 0, 0.118}));
  const int finger = world.add(Shape::capsule(0.04, 0.008), at({0.05, 0, 0.12}));
  Manifold manifold;
  for (int f = 0; f < frames; ++f) {
    const std::span<const Touch> touches = world.touches(2e-3);
    manifold.reduce(touches);
    Vec<double, 6> twist;
    twist << 3e-4 * std::sin(0.05 * f), 3e-4 * std::cos(0.05 * f), f < 30 ? -3e-4 : 0, 0, 0, 1e-3;
    const std::array moves{Move{palm, twist}, Move{finger, twist}};
    const TimeOfContact toc = world.time_of_contact(moves);
    for (const Move& m : moves)
      world.place(m.collider, retract(world.pose(m.collider), Vec<double, 6>(toc.time * m.twist)));
    look(f, touches, toc, manifold);
  }
}

TEST(World, GivesTheSameBitsForTheSameCalls) {
  std::vector<double> first, second;
  for (auto* list : {&first, &second}) {
    World world;
    drag_palm(world, 100, [&](int, std::span<const Touch> touches, const TimeOfContact& toc, const Manifold& manifold) {
      list->push_back(toc.time);
      list->push_back(static_cast<double>(manifold.kept().size()));
      for (const Touch& t : touches) list->insert(list->end(), {t.gap, t.normal.x(), t.point_a.z()});
    });
  }
  ASSERT_EQ(first.size(), second.size());
  EXPECT_GT(first.size(), 1000u);
  EXPECT_EQ(std::memcmp(first.data(), second.data(), first.size() * sizeof(double)), 0);
}

TEST(World, AllocatesNothingAfterWarmUp) {
  World world;
  long warm = 0, last = 0;
  std::size_t seen = 0;
  drag_palm(world, 700, [&](int frame, std::span<const Touch> touches, const TimeOfContact&, const Manifold&) {
    if (frame == 350) warm = allocations();
    if (frame > 350) seen += touches.size();
    last = allocations();
  });
  EXPECT_GT(seen, 100u);
  EXPECT_EQ(last - warm, 0);
}

TEST(Manifold, KeepsFewWithTheClosestAndSpreadsThem) {
  World world;
  const auto mesh = tree(meshes::plate({0.3, 0.3, 0.02}, 20000));
  world.add(mesh);
  world.add(Shape::rounded_box({0.08, 0.09, 0.02}, 0.005), at({0, 0, 0.0203}));
  world.add(Shape::capsule(0.06, 0.008), at({0.1, 0, 0.0182}));
  const auto touches = world.touches(2e-3);
  Manifold manifold;
  manifold.reduce(touches);
  EXPECT_GT(touches.size(), 100u);
  ASSERT_EQ(manifold.kept().size(), 8u) << "four under the palm, and no leaning normals of the finger's neighbours";
  Vec3 low = Vec3::Constant(1), high = -low;
  for (const std::uint32_t i : manifold.kept())
    if (touches[i].a == 1) {
      EXPECT_GT(touches[i].normal.z(), std::cos(Manifold::cone));
      low = low.cwiseMin(touches[i].point_b);
      high = high.cwiseMax(touches[i].point_b);
    }
  EXPECT_GT(high.x() - low.x(), 0.06);
  EXPECT_GT(high.y() - low.y(), 0.07);
}

TEST(Manifold, CompletesWithTheMostViolatedAndThenHasNothingToAdd) {
  World world;
  world.add(tree(meshes::plate({0.3, 0.3, 0.02}, 20000)));
  world.add(Shape::rounded_box({0.08, 0.09, 0.02}, 0.005), at({0, 0, 0.0203}));
  const auto touches = world.touches(2e-3);
  Manifold manifold(1);
  manifold.reduce(touches);
  ASSERT_EQ(manifold.kept().size(), 1u);
  std::vector<Vec<double, 6>> twist(2, Vec<double, 6>::Zero());
  EXPECT_EQ(manifold.complete(touches, world, twist, 1e-4, 1e-6), 0) << "nobody moves";
  EXPECT_EQ(manifold.complete(touches, world, twist, 0.1, 1e-6, false), 0) << "less than that was there before";
  twist[1] << 0, 0, 0, 0.02, 0, 0;  // one side dips by 0.9 mm
  ASSERT_EQ(manifold.complete(touches, world, twist, 1e-4, 1e-6), 1);
  const Touch& added = touches[manifold.kept().back()];
  for (const Touch& t : touches) EXPECT_LE(std::abs(t.point_b.y()), std::abs(added.point_b.y()) + 5e-3);
  EXPECT_LT(added.point_b.y(), 0) << "the side that dips";
}

}  // namespace
}  // namespace zwang::collision
