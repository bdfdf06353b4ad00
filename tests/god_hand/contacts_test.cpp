#include <zwang/experiments/god_hand/step/contacts.h>

#include <gtest/gtest.h>

#include "tests/god_hand/tracked.h"

namespace zwang::god {
namespace {

using collision::Shape;

// By looking at every triangle, in the mesh's axes.
double gap_of(const Shape& shape, const Pose<double>& pose, const collision::Tree& mesh) {
  double least = 1;
  for (const collision::Triangle& t : mesh.triangles())
    least = std::min(least, closest(shape, pose, {.triangle = &t}, shape.radius() + 3e-3).distance - shape.radius());
  return least;
}

// Rows are spheres that are part of a shape: none may say less than the shape's own gap, and what one says is the
// distance of its two points. Fine meshes, on which patches of triangles stand in for their members.
TEST(Rows, SayTheGapOfTheirPointsAndNeverLessThanTheShape) {
  Draw draw(3);
  for (const collision::Mesh& mesh : {meshes::gear(0.05, 0.02, 12, 20000), meshes::bumpy_sphere(0.05, 0.003, 9, 20000),
                                      meshes::plate({0.1, 0.1, 0.02}, 20000)}) {
    Surroundings s{.name = "part"};
    s.objects.push_back(fixed(mesh));
    const collision::Tree& tree = *s.objects[0].mesh;
    for (const Shape& shape :
         {Shape::sphere(0.008), Shape::capsule(0.05, 0.008), Shape::rounded_box({0.08, 0.09, 0.02}, 0.005)}) {
      GodObjects objects;
      objects.add(box_body({0.02, 0.02, 0.02}, 0.1, Vec3::Zero()), shape);
      Contacts contacts(objects, s);
      int near = 0;
      for (int draws = 0; draws < 4000 && near < 3; ++draws) {
        const Pose<double> pose{draw.uniform(0.01, 0.08) * draw.direction(), rotation(draw.cube(2))};
        contacts.place(0, pose);
        using Choice = Contacts::Choice;
        contacts.find_rows(2e-3, std::array{Choice::few, Choice::all, Choice::raw}[draws % 3]);
        if (contacts.rows().empty() || contacts.gap(1e-3) < 1e-5) continue;
        const double truth = gap_of(shape, pose, tree);
        ++near;
        for (const auto& [t, key, lift] : contacts.rows()) {
          ASSERT_GE(t.gap, truth - 1e-9);
          ASSERT_LT((t.point_a - t.point_b - t.gap * t.normal).norm(), 1e-9);
          const Vec3 center = t.point_a + shape.radius() * t.normal;
          const Vec3 local = pose.rotation.transpose() * (center - pose.position);
          ASSERT_LT((local - shape.nearest(local)).norm(), 1e-9) << "beside the core";
          ASSERT_LT(nearest(tree, t.point_b, 1)->distance, 1e-9) << "off the mesh";
        }
      }
      EXPECT_EQ(near, 3);
    }
  }
}

bool is_same(const Contacts::Row& a, const Contacts::Row& b) {
  return a.touch.a == b.touch.a && a.touch.b == b.touch.b && (a.touch.point_a - b.touch.point_a).norm() < 1e-9 &&
         (a.touch.normal - b.touch.normal).norm() < 1e-9;
}

// What a motion into a fine surface would cross is given back, none of it twice; all of it are rows that there are
// where nothing is left out, too.
TEST(Rows, AreGivenBackAmongAll) {
  Draw draw(5);
  Surroundings s{.name = "part"};
  s.objects.push_back(fixed(meshes::bumpy_sphere(0.05, 0.003, 9, 20000)));
  GodObjects objects;
  objects.add(box_body({0.02, 0.02, 0.02}, 0.1, Vec3::Zero()), Shape::capsule(0.05, 0.008));
  Contacts contacts(objects, s);
  std::size_t given_back = 0;
  for (int draws = 0; draws < 200; ++draws) {
    const Vec3 out = draw.direction();
    contacts.place(0, {draw.uniform(0.058, 0.062) * out, rotation(draw.cube(2))});
    Vec<double, 6> motion;
    motion << -0.004 * out, draw.cube(0.05);
    contacts.find_rows(2e-3, Contacts::Choice::few);
    const std::size_t few = contacts.rows().size();
    if (few == 0) continue;
    while (contacts.complete(std::span(&motion, 1), 2e-4, true) > 0) continue;
    given_back += contacts.rows().size() - few;
    const std::vector<Contacts::Row> completed(contacts.rows().begin(), contacts.rows().end());
    contacts.find_rows(2e-3, Contacts::Choice::all);
    for (const Contacts::Row& row : completed)
      EXPECT_TRUE(std::any_of(contacts.rows().begin(), contacts.rows().end(),
                              [&](const Contacts::Row& other) { return is_same(other, row); }));
    for (std::size_t k = 0; k < completed.size(); ++k)
      for (std::size_t other = 0; other < k; ++other) EXPECT_FALSE(is_same(completed[k], completed[other]));
  }
  EXPECT_GT(given_back, 0u);
}

}  // namespace
}  // namespace zwang::god
