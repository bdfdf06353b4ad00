#include <gtest/gtest.h>
#include <Eigen/LU>
#include <Eigen/QR>

#include <map>
#include <set>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/scenes/hand.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/constraints/contact.h>
#include <zwang/constraints/joint_limit.h>
#include <zwang/core/model/assemble.h>
#include <zwang/core/problem/islands.h>
#include <zwang/core/referee/measure.h>

namespace zwang {
namespace {

const std::vector<std::string> physical{"tower", "stack",    "wall",  "pile", "arch",
                                        "chain", "four_bar", "leash", "hand", "hands"};

Instance only(const std::string& text) { return make_scenes(text).at(0); }

double seen(const Instance& instance) {
  const Problem& p = instance.problem;
  return (Vector(p.J * p.z_u) - p.c).norm();
}

TEST(PhysicalScenes, AreValidProblemsWhoseRowsHaveDifferentNamesAndKeys) {
  for (const std::string& name : physical) {
    const Instance instance = only(name);
    require_matching_sizes(instance.problem);
    EXPECT_EQ(bad_input(instance.problem), "") << name;
    EXPECT_TRUE(is_positive_definite(instance.problem.M)) << name;
    ASSERT_EQ(instance.origin.size(), instance.problem.key.size()) << name;
    std::set<std::string> names;
    for (const RowOrigin& origin : instance.origin) names.insert(to_string(origin));
    EXPECT_EQ(names.size(), instance.origin.size());
    EXPECT_EQ(std::set<RowKey>(instance.problem.key.begin(), instance.problem.key.end()).size(),
              instance.origin.size());
  }
}

TEST(PhysicalScenes, AreTheSameForTheSameSeedAndDifferForAnother) {
  for (const std::string& name : physical) {
    const SceneEntry& scene = *find_scene(name);
    EXPECT_EQ(seen(only(name)), seen(only(name))) << name;
    const auto has_seed = [](const Knob& k) { return k.name == "seed"; };
    if (std::any_of(scene.knobs.begin(), scene.knobs.end(), has_seed)) {
      EXPECT_NE(seen(only(name + "(seed=1)")), seen(only(name + "(seed=2)"))) << name;
    }
  }
}

TEST(PhysicalScenes, ClosedFormsMeetTheKktConditions) {
  for (const std::string text : {"tower(boxes=1,7,100)", "stack(boxes=1,30,push=0)", "wall(boxes=1,5,25,100,push=0)"}) {
    int found = 0;
    for (const Instance& instance : make_scenes(text)) {
      if (!instance.reference) continue;
      ++found;
      const Problem& p = instance.problem;
      const Reference& r = *instance.reference;
      EXPECT_EQ(r.method, "closed form");
      EXPECT_EQ(r.z.norm(), 0);
      const Vector force = p.J.transpose() * r.lambda - p.M * (r.z - p.z_u);
      EXPECT_LE(force.cwiseAbs().maxCoeff(), 1e-13 * r.lambda.maxCoeff() * static_cast<double>(p.rows())) << p.name;
      EXPECT_GE(r.lambda.minCoeff(), 0);
      EXPECT_GE((p.J * r.z - p.c).minCoeff(), 0);
    }
    EXPECT_GE(found, 2) << text;
  }
}

TEST(Hand, HasSeventyJointRowsTheViolatedLimitsAndTheContacts) {
  for (const int limits : {0, 5, 20})
    for (const int contacts : {0, 4, 200}) {
      const Instance hand =
          only("hand(limits=" + std::to_string(limits) + ",contacts=" + std::to_string(contacts) + ")");
      std::map<std::string, int> rows;
      for (const RowOrigin& origin : hand.origin) ++rows[origin.type];
      EXPECT_EQ(hand.problem.size(), 96);
      EXPECT_EQ(rows["universal_joint"], 20);
      EXPECT_EQ(rows["revolute_joint"], 50);
      EXPECT_EQ(rows["joint_limit"], limits);
      EXPECT_EQ(rows["contact"], contacts);
    }
}

TEST(Hand, AssembledPosesCloseAllJointsAndAnglesAreTheLimitsAngles) {
  hand::Angles angles;
  for (int k = 0; k < hand::angles; ++k) {
    const auto [low, high] = hand::range(k);
    angles[static_cast<std::size_t>(k)] = low + (high - low) * (k + 1) / 22;
  }
  Scene scene;
  Pose<double> palm;
  palm.position = {1, 2, 3};
  hand::add(scene, hand::forward_kinematics(palm, angles));
  Assembler assembler;
  Problem problem;
  assembler.assemble(scene, Vector::Zero(6 * hand::bodies), {.dt = 1}, problem);
  ASSERT_EQ(problem.rows(), 70) << "no limit is violated";
  for (Index i = 0; i < 70; ++i)
    EXPECT_NEAR(problem.c[i], 0, 1e-15) << to_string(assembler.origin(scene, problem)[static_cast<std::size_t>(i)]);
  auto& limits = scene.list_of<JointLimit>();
  ASSERT_EQ(limits.size(), 40u);
  for (std::size_t i = 0; i < 40; ++i) {
    const JointLimit& limit = limits.all[i];
    const auto body = [&](int k) {
      return scene.bodies[static_cast<std::size_t>(limit.bodies[static_cast<std::size_t>(k)])].pose;
    };
    const double angle = angles[i / 2];
    EXPECT_NEAR(limit.value(body(0), body(1))[0], limit.side == Side::lower ? angle - limit.bound : limit.bound - angle,
                1e-14)
        << limits.label(i);
  }
}

bool same_bits(const Problem& a, const Problem& b) {
  return Matrix(a.M) == Matrix(b.M) && Matrix(a.J) == Matrix(b.J) && a.z_u == b.z_u && a.c == b.c && a.kind == b.kind &&
         a.key == b.key;
}

// Every body of a posed scene moves a little, the same in every call.
void move_bodies(SceneStep& posed, Draw& draw) {
  for (Body& body : posed.scene.bodies) {
    Vec<double, 6> twist;
    twist << draw.cube(1e-3), draw.cube(1e-2);
    if (body.motion == Motion::free) body.pose = retract(body.pose, twist);
  }
}

SceneStep posed_hands(double hands, double contacts) {
  return pose_hands(
      {{"hands", hands}, {"contacts", contacts}, {"limits", 5}, {"drift", 1e-4}, {"feasible", 1}, {"seed", 1}});
}

TEST(Assembler, AllocatesNothingWhileTheRowsStay) {
  SceneStep posed = posed_hands(2, 64);
  const Vector z_u = unconstrained(posed);
  for (const Mode mode : {Mode::quasi_static, Mode::dynamic}) {
    posed.options.mode = mode;
    Assembler assembler;
    Problem problem;
    assembler.assemble(posed.scene, z_u, posed.options, problem);
    assembler.assemble(posed.scene, z_u, posed.options, problem);
    ASSERT_EQ(problem.rows(), 2 * (70 + 5 + 64));
    const long before = allocations();
    for (int frame = 0; frame < 20; ++frame) {
      for (Body& body : posed.scene.bodies) body.pose.position += Vec3(1e-3, 0, 0);
      assembler.assemble(posed.scene, z_u, posed.options, problem);
    }
    EXPECT_EQ(allocations() - before, 0);
  }
}

// Limits come and go, contacts vanish, a body is held and let go: the kept pattern must notice.
TEST(Assembler, KeepsNothingOfAFrameWhoseRowsHaveChanged) {
  SceneStep posed = posed_hands(1, 12);
  const Vector z_u = unconstrained(posed);
  auto& contacts = posed.scene.list_of<Contact>();
  Draw draw(7);
  Assembler kept;
  Problem problem;
  std::set<Index> counts;
  for (int frame = 0; frame < 60; ++frame) {
    move_bodies(posed, draw);
    if (frame % 7 == 3) contacts.all.pop_back(), contacts.labels.pop_back(), contacts.keys.pop_back();
    if (frame % 7 == 5) std::swap(contacts.all.front(), contacts.all.back());
    if (frame % 11 == 4) std::swap(contacts.keys.front(), contacts.keys.back());
    posed.scene.bodies[1].motion = frame % 13 == 6 ? Motion::fixed : Motion::free;
    Problem fresh;
    Assembler anew;
    const Index unknowns = 6 * (hand::bodies - (frame % 13 == 6));
    kept.assemble(posed.scene, z_u.head(unknowns), posed.options, problem);
    anew.assemble(posed.scene, z_u.head(unknowns), posed.options, fresh);
    ASSERT_TRUE(same_bits(problem, fresh)) << "frame " << frame;
    ASSERT_EQ(kept.origin(posed.scene, problem), anew.origin(posed.scene, fresh)) << "frame " << frame;
    ASSERT_EQ(kept.skipped(posed.scene), anew.skipped(posed.scene)) << "frame " << frame;
    counts.insert(problem.rows());
  }
  EXPECT_GE(counts.size(), 8u) << "the rows hardly changed: nothing was tested";
}

TEST(Assembler, WritesTheWholeOfAnyProblemItIsHanded) {
  SceneStep posed = posed_hands(1, 4);
  const Vector z_u = unconstrained(posed);
  Assembler assembler;
  Problem first, second = only("tower(boxes=3)").problem;
  assembler.assemble(posed.scene, z_u, posed.options, first);
  assembler.assemble(posed.scene, z_u, posed.options, second);
  EXPECT_TRUE(same_bits(first, second));
}

// The paper's form needs k with J k = c. With several contacts on one face of one bone there is none.
TEST(Hand, RightHandSideLeavesTheRangeOfJWithManyContacts) {
  const auto outside = [](const Instance& hand) {
    const Matrix J(hand.problem.J);
    const Vector k = J.completeOrthogonalDecomposition().solve(hand.problem.c);
    return (J * k - hand.problem.c).norm() / hand.problem.c.norm();
  };
  EXPECT_LE(outside(only("hand(contacts=0)")), 1e-12);
  EXPECT_GE(outside(only("hand(contacts=64)")), 1e-3);
}

TEST(Hand, TwoHandsAreTwoIslands) {
  Islands islands;
  islands.split(only("hands(hands=2,contacts=8)").problem);
  ASSERT_EQ(islands.all().size(), 2u);
  EXPECT_EQ(islands.all()[0].problem.size(), 96);
  EXPECT_EQ(islands.all()[0].problem.rows(), islands.all()[1].problem.rows());
}

TEST(FourBar, HasThreeRedundantRowsThatAgree) {
  const Instance linkage = only("four_bar");
  const Matrix J(linkage.problem.J);
  EXPECT_EQ(J.rows(), 20);
  EXPECT_EQ(J.fullPivLu().rank(), 17);
  EXPECT_EQ(linkage.problem.c.norm(), 0);
}

}  // namespace
}  // namespace zwang
