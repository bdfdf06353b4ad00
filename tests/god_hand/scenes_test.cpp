#include <zwang/experiments/god_hand/scenes/scenes.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include <zwang/collision/world.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/god_hand/step/physics.h>
#include "tests/folders.h"
#include "tests/recorded_data.h"

namespace zwang::god {
namespace {

namespace fs = std::filesystem;

// What a hand or a loose object meets of it.
void add_to(collision::World& world, const Object& object, std::uint64_t bit) {
  if (object.mesh && !object.loose()) {
    world.add(object.mesh, object.pose);
    return;
  }
  for (const Object::Piece& piece : object.pieces)
    world.add(piece.shape, {object.pose * piece.at.position, object.pose.rotation * piece.at.rotation}, {bit, ~bit},
              !object.loose());
}

class Scene : public testing::TestWithParam<std::string> {
 protected:
  Surroundings made() const { return make_surroundings(GetParam(), {}); }
};

TEST_P(Scene, LooseObjectsStartClearAndRest) {
  const Surroundings s = made();
  collision::World world;
  std::uint64_t bit = 1;
  for (const Object& object : s.objects) add_to(world, object, object.loose() ? bit *= 2 : 1);
  for (const collision::Touch& touch : world.touches(1e-3)) EXPECT_GE(touch.gap, 1e-5);
  if (size_of(s).loose == 0) return;

  Physics physics(s);
  for (int k = 0; k < 300; ++k) physics.step(1e-3, {});
  std::vector<Pose<double>> settled;
  for (std::size_t k = 0; k < s.objects.size(); ++k) settled.push_back(physics.pose(k));
  for (int k = 0; k < 1000; ++k) physics.step(1e-3, {});
  for (std::size_t k = 0; k < s.objects.size(); ++k) {
    if (!s.objects[k].loose()) continue;
    EXPECT_LT((settled[k].position - s.objects[k].pose.position).norm(), 2e-3) << s.objects[k].name;
    EXPECT_LT((physics.pose(k).position - settled[k].position).norm(), 5e-4) << s.objects[k].name;
    EXPECT_LT(rotation_vector<double>(physics.pose(k).rotation * settled[k].rotation.transpose()).norm(), 0.02)
        << s.objects[k].name;
  }
}

TEST_P(Scene, ASecondOneIsTheSame) {
  const Surroundings a = made(), b = made();
  ASSERT_EQ(a.objects.size(), b.objects.size());
  EXPECT_EQ(a.focus, b.focus);
  for (std::size_t k = 0; k < a.objects.size(); ++k) {
    EXPECT_EQ(a.objects[k].pose.position, b.objects[k].pose.position);
    EXPECT_EQ(a.objects[k].inertia, b.objects[k].inertia);
    EXPECT_EQ(a.objects[k].pieces.size(), b.objects[k].pieces.size());
    ASSERT_EQ(a.objects[k].mesh == nullptr, b.objects[k].mesh == nullptr);
    if (a.objects[k].mesh) {
      EXPECT_EQ(a.objects[k].mesh->size(), b.objects[k].mesh->size());
    }
  }
}

// A palm-sized ball set down on the focus meets something.
TEST_P(Scene, TheFocusLiesOnASurface) {
  const Surroundings s = made();
  collision::World world;
  world.add(collision::Shape::sphere(0.03), {s.focus, Mat3::Identity()});
  std::uint64_t bit = 2;
  for (const Object& object : s.objects) add_to(world, object, bit *= 2);
  double gap = 1;
  for (const collision::Touch& touch : world.touches(1e-3))
    if (touch.a == 0) gap = std::min(gap, touch.gap);
  EXPECT_LT(gap, 0);
}

INSTANTIATE_TEST_SUITE_P(All, Scene, testing::ValuesIn([] {
                           std::vector<std::string> names;
                           for (const auto& [name, line] : scenes()) names.push_back(name);
                           return names;
                         }()),
                         [](const auto& info) { return info.param; });

void expect_size(const std::string& scene, const fs::path& parts, std::size_t triangles, std::size_t largest,
                 std::size_t fixed) {
  const Surroundings made = make_surroundings(scene, parts);
  const SceneSize size = size_of(made);
  std::size_t most = 0;
  for (const Object& object : made.objects)
    if (!object.loose() && object.mesh) most = std::max<std::size_t>(most, object.mesh->size());
  EXPECT_NEAR(static_cast<double>(size.triangles), static_cast<double>(triangles), 0.1 * static_cast<double>(triangles))
      << scene;
  EXPECT_NEAR(static_cast<double>(most), static_cast<double>(largest), 0.1 * static_cast<double>(largest)) << scene;
  EXPECT_NEAR(static_cast<double>(size.fixed), static_cast<double>(fixed), 0.1 * static_cast<double>(fixed)) << scene;
}

TEST(Scenes, AreAsLargeAsTheySay) {
  expect_size("simple", {}, 100000, 30000, 6);
  expect_size("engine", {}, 1000000, 100000, 22);
  expect_size("detailed", {}, 1200000, 400000, 3);
  expect_size("wall", {}, 20000, 20000, 1);
  expect_size("plate", {}, 20000, 20000, 1);
  expect_size("holes", {}, 50000, 50000, 1);
}

TEST(Scenes, OfRealParts) {
  const fs::path data = test::recorded_data();
  if (!fs::exists(data / "mesh_differential")) GTEST_SKIP() << "no real parts at " << data;
  expect_size("simple", data, 104000, 57000, 6);
  expect_size("engine", data, 1017850, 105936, 21);
  const std::string ring = (data / "mesh_differential/diff_ring.stl").string();
  const Surroundings two = make_surroundings(ring + "@mm," + ring + "@mm", {});
  ASSERT_EQ(two.objects.size(), 2u);
  EXPECT_EQ(two.objects[0].mesh, two.objects[1].mesh);
  EXPECT_NEAR(two.objects[0].pose.position.z() + two.objects[0].mesh->box().max().z(), 0, 1e-12);
  EXPECT_THROW(make_surroundings(ring + "@mn", {}), BadFile);
}

void expect_line(const std::string& scene, const fs::path& parts, const std::string& part) {
  try {
    make_surroundings(scene, parts);
    ADD_FAILURE() << scene << " was made";
  } catch (const std::exception& e) {
    EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
  }
}

TEST(Scenes, BadOnesGetOneLine) {
  const fs::path folder = own_path("scenes");
  fs::create_directories(folder);
  std::ofstream(folder / "empty.stl").close();
  std::ofstream(folder / "words.obj") << "these are words\n";
  expect_line("simpel", {}, "did you mean 'simple'? (./zwang simulate --help lists all)");
  expect_line("wall", folder, "not made of real parts");
  expect_line("simple", folder, "no diff_ring.stl");
  expect_line("simple", folder / "nowhere", "nowhere");
  expect_line((folder / "empty.stl").string(), {}, "empty.stl");
  expect_line((folder / "words.obj@mm").string(), {}, "words.obj");
  expect_line((folder / "none.stl").string(), {}, "none.stl");
  expect_line("a.stl,,b.stl", {}, "a.stl");
  // A pinion of 32 mm whose file is in millimetres.
  std::ofstream(folder / "part.obj") << "v 0 0 0\nv 32 0 0\nv 0 32 0\nf 1 2 3\n";
  const std::string part = (folder / "part.obj").string();
  expect_line(part, {}, "32 m wide; give its unit, such as part.obj@mm");
  expect_line(part + "@um", {}, "3.2e-05 m wide; in its unit 1 mm to 50 m expected");
  EXPECT_EQ(make_surroundings(part + "@mm", {}).objects.size(), 1u);
  EXPECT_EQ(make_surroundings(part + "@m", {}).objects.size(), 1u);
}

}  // namespace
}  // namespace zwang::god
