#include <zwang/bench/capture/capture.h>

#include <gtest/gtest.h>

#include <fstream>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/problem.h>
#include <zwang/core/referee/measure.h>
#include <zwang/solvers/registry.h>
#include "tests/folders.h"

namespace zwang {
namespace {

// A box of 2 kg lies on the floor, tied to a ball by an equality; the door's hinge stands at its limit.
constexpr auto model = R"(<mujoco>
  <option timestep="0.002"/>
  <worldbody>
    <geom name="floor" type="plane" size="3 3 .1"/>
    <body name="box" pos="0 0 .0999"><freejoint/><geom name="box" type="box" size=".1 .1 .1" mass="2" friction=".7"/></body>
    <body name="ball" pos="1 0 1"><freejoint/><geom name="ball" type="sphere" size=".1" mass="1" condim="1"/></body>
    <body name="door" pos="-1 0 .5"><joint name="hinge" type="hinge" axis="0 1 0" range="0 1" limited="true"/>
      <geom name="leaf" type="box" size=".1 .01 .1" pos=".1 0 0" mass="1"/></body>
  </worldbody>
  <equality><connect name="tie" body1="ball" body2="world" anchor="0 0 0"/></equality>
</mujoco>)";

struct Capture : testing::Test {
  std::filesystem::path file = own_path("model.xml");
  ~Capture() override { std::filesystem::remove(file); }
  void write(const std::string& text) { std::ofstream(file) << text; }
};

TEST_F(Capture, ProblemsAreMuJoCosWithoutItsSoftness) {
  write(model);
  std::vector<Instance> all;
  capture({.model = file, .steps = 20, .every = 5}, [&](int step, const Instance& instance) {
    EXPECT_EQ(step % 5, 0);
    all.push_back(instance);
  });
  ASSERT_EQ(all.size(), 4u);
  const Instance& first = all[0];
  EXPECT_EQ(first.problem.size(), 13);  // two free bodies and a hinge
  EXPECT_EQ(bad_input(first.problem), "");
  int equalities = 0, contacts = 0;
  for (Index i = 0; i < first.problem.rows(); ++i) {
    equalities += first.problem.is_equality(i);
    contacts += first.origin[static_cast<std::size_t>(i)].type == "contact";
  }
  EXPECT_EQ(equalities, 3);
  EXPECT_EQ(contacts, 4);
  for (const Instance& instance : all) {
    Solution s;
    make_solver("dual_active_set").solve(instance.problem, {}, s);
    EXPECT_EQ(measure(instance.problem, s, nullptr, 1e-9).verdict, Verdict::solved);
    ASSERT_EQ(instance.recorded.size(), 1u);
    EXPECT_EQ(instance.recorded[0].by, "mujoco");
    // MuJoCo's rows give way: its answer lies near the hard one, and is not it.
    const double apart = (instance.recorded[0].z - s.z).norm(), size = instance.problem.z_u.norm();
    EXPECT_GT(apart, 1e-8 * size);
    EXPECT_LT(apart, size);
  }
  EXPECT_EQ(all[0].problem.key, all[1].problem.key);  // nothing came or went
}

TEST_F(Capture, ContactsHaveTheModelsFrictionWhenAsked) {
  write(model);
  std::vector<Instance> with, without;
  capture({.model = file, .steps = 20, .every = 5, .friction = true},
          [&](int, const Instance& instance) { with.push_back(instance); });
  capture({.model = file, .steps = 20, .every = 5},
          [&](int, const Instance& instance) { without.push_back(instance); });
  for (std::size_t k = 0; k < with.size(); ++k) {
    const Problem& p = with[k].problem;
    EXPECT_EQ(bad_input(p), "");
    EXPECT_EQ(p.law, Law::coulomb);
    EXPECT_TRUE(with[k].recorded.empty());  // MuJoCo's own run is frictionless
    EXPECT_EQ(problem_sha256(under(Law::frictionless, p)), problem_sha256(without[k].problem));
    int slipping = 0;
    for (Index i = 0; i < p.rows(); ++i) {
      if (p.kind[static_cast<std::size_t>(i)] != RowKind::inequality || p.tangents(i) == 0) continue;
      ++slipping;
      EXPECT_EQ(p.tangents(i), 2);
      EXPECT_EQ(p.mu[i], 1);  // MuJoCo takes the larger one, the floor's
      EXPECT_EQ(p.key[static_cast<std::size_t>(i) + 2].row, p.key[static_cast<std::size_t>(i)].row + 2);
      // One scale a contact: the rows of the box's centre are orthonormal.
      for (Index r = i; r < i + 3; ++r) EXPECT_NEAR(p.J.row(r).head(3).norm(), 1, 1e-12);
    }
    EXPECT_EQ(slipping, 4);  // the ball touches nothing
  }
}

// MuJoCo orders a pair's geoms by their bodies, a contact's by their types.
TEST_F(Capture, APairsOwnDimensionCountsInEitherOrder) {
  for (const auto& [geoms, pair] : {std::pair("1", "3"), {"3", "1"}}) {
    write(std::string(R"(<mujoco><worldbody>
      <body name="A"><freejoint/><geom name="box" type="box" size=".1 .1 .1" mass="2" condim=")") +
          geoms + R"("/></body><body name="B" pos="0 0 .1999"><freejoint/>
      <geom name="ball" type="sphere" size=".1" mass="1" condim=")" +
          geoms + R"("/></body></worldbody><contact><pair geom1="box" geom2="ball" condim=")" + pair +
          R"(" friction="0.7 0.7 .005 .0001 .0001"/></contact></mujoco>)");
    int contacts = 0;
    capture({.model = file, .steps = 1, .friction = true}, [&](int, const Instance& instance) {
      const Problem& p = instance.problem;
      ++contacts;
      EXPECT_EQ(p.rows(), *pair == '3' ? 3 : 1);
      EXPECT_EQ(p.has_tangents() ? p.mu[0] : 0, *pair == '3' ? 0.7 : 0);
    });
    EXPECT_EQ(contacts, 1);
  }
}

TEST_F(Capture, KeepsWhatTheFileFormatHolds) {
  write(model);
  const std::filesystem::path stored = own_path("captured.h5");
  capture({.model = file, .steps = 1}, [&](int, const Instance& instance) {
    write_problem(stored, instance);
    const Instance again = read_problems(stored).at(0);
    EXPECT_EQ(problem_sha256(again.problem), problem_sha256(instance.problem));
    EXPECT_EQ(again.recorded.at(0).z, instance.recorded.at(0).z);
  });
  std::filesystem::remove(stored);
}

TEST_F(Capture, AModelThatIsNotThereIsNamed) {
  try {
    capture({.model = "nowhere.xml", .steps = 1}, [](int, const Instance&) {});
    FAIL();
  } catch (const BadFile& bad) {
    EXPECT_STREQ(bad.what(), "nowhere.xml: no such file");
  }
}

TEST_F(Capture, SaysWhatIsWrongInOneLine) {
  for (const auto& [text, word] :
       {std::pair("<mujoco><worldbody><body><geom/></body></worldboddy></mujoco>", "MuJoCo says"),
        std::pair("<mujoco/>", "nothing in this model moves")}) {
    write(text);
    try {
      capture({.model = file, .steps = 1}, [](int, const Instance&) {});
      FAIL() << word;
    } catch (const BadFile& bad) {
      EXPECT_NE(std::string(bad.what()).find(word), std::string::npos) << bad.what();
      EXPECT_EQ(std::string(bad.what()).find('\n'), std::string::npos) << bad.what();
    }
  }
}

}  // namespace
}  // namespace zwang
