// Scenes with friction: those that have it by a knob, and those in which it decides.
#include <zwang/bench/scenes/friction/friction.h>

#include <gtest/gtest.h>

#include <algorithm>

#include <zwang/bench/scenes/friction/families.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/law.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

Instance only(const std::string& text) { return make_scenes(text).at(0); }

double mu_by_default(const SceneEntry& scene) {
  const auto knob = std::ranges::find(scene.knobs, "mu", &Knob::name);
  return knob == scene.knobs.end() ? -1 : knob->value;
}

TEST(FrictionKnob, LeavesTheRowsThatWereThere) {
  int asked = 0;
  for (const SceneEntry& scene : scenes()) {
    if (mu_by_default(scene) < 0) continue;
    ++asked;
    const Instance without = only(scene.name + "(mu=0)"), with = only(scene.name + "(mu=0.5)");
    EXPECT_FALSE(without.problem.has_tangents()) << scene.name;
    ASSERT_TRUE(with.problem.has_tangents()) << scene.name;
    EXPECT_EQ(bad_input(with.problem), "") << scene.name;
    EXPECT_EQ(with.origin.size(), with.problem.kind.size()) << scene.name;
    EXPECT_EQ(problem_sha256(under(Law::frictionless, with.problem)), problem_sha256(without.problem)) << scene.name;
    EXPECT_EQ(problem_sha256(only(scene.name).problem),
              problem_sha256(mu_by_default(scene) > 0
                                 ? only(scene.name + "(mu=" + std::to_string(mu_by_default(scene)) + ")").problem
                                 : without.problem));
  }
  const auto families = static_cast<int>(friction_families().size());  // they are nothing without friction
  EXPECT_EQ(asked + families + 5, static_cast<int>(scenes().size()));  // five have no contacts
}

TEST(FrictionKnob, ProblemsWithAndWithoutFrictionAreTwoFamilies) {
  EXPECT_EQ(only("tower(boxes=2)").family, "tower");
  EXPECT_EQ(only("tower(boxes=2,mu=0.5)").family, "tower with friction");
  EXPECT_EQ(only("incline").family, "incline");
  EXPECT_EQ(only("ROD").family, "ROD");
}

TEST(FrictionFamilies, AreScenesAndSayHowManySolutionsThereAre) {
  for (const auto& family : friction_families()) ASSERT_TRUE(find_scene(family.first)) << family.first;
  const auto method = [](const char* text) {
    const Instance in = only(text);
    return in.reference ? in.reference->method : "";
  };
  EXPECT_EQ(method("ROD"), "closed form, 3 solutions");
  EXPECT_EQ(method("ROD(above=0)"), "closed form, 1 solution");
  EXPECT_EQ(method("HELD"), "closed form, 2 solutions");
  EXPECT_EQ(method("JAM"), "closed form, 1 solution");
  EXPECT_EQ(method("JAM(beyond=1)"), "closed form, 0 solutions");
  EXPECT_EQ(method("PINCH"), "closed form, a continuum of solutions");
  EXPECT_EQ(method("PUCK"), "known answer, a continuum of solutions");
}

TEST(FrictionKnob, OfAllScenesOfAText) {
  const std::vector<Instance> both = make_scenes("tower(boxes=2),incline(mu=0.25)", 1, 0.5);
  EXPECT_EQ(both[0].problem.name, "tower(boxes=2,mu=0.5)");
  EXPECT_EQ(both[0].problem.mu[0], 0.5);
  EXPECT_EQ(both[1].problem.name, "incline(mu=0.25)");
  EXPECT_NO_THROW(make_scenes("chain", 1, 0.5));
  EXPECT_THROW(make_scenes("tower", 1, -0.5), std::invalid_argument);
}

// References stay where friction has nothing to do.
TEST(FrictionKnob, KeepsWhatIsStillTrue) {
  for (const char* text : {"tower(boxes=3,mu=0.5)", "MR(k=8,mu=0.5)", "GAP(k=8,mu=0.5)"}) {
    const Instance in = only(text);
    ASSERT_TRUE(in.reference) << text;
    const Vector& known = in.reference->feasible ? in.reference->lambda : in.reference->certificate;
    ASSERT_EQ(known.size(), in.problem.rows()) << text;
    const Vector force = in.problem.J.transpose() * known;
    if (in.reference->feasible) {
      EXPECT_LE((in.problem.M * (in.reference->z - in.problem.z_u) - force).cwiseAbs().maxCoeff(), 1e-10) << text;
    } else {
      EXPECT_TRUE(force.isZero(0));
      EXPECT_GT(known.dot(in.problem.c), 0);
    }
  }
  EXPECT_FALSE(only("MANYF(mu=0.5)").reference);  // it slides
}

// Other factors for the rows of one contact would make its cone an ellipse.
TEST(QuarterTurns, AreOrthogonalExactAndAsLong) {
  for (const char* text : {"NPI(mu=0.5)", "WEAK(mu=0.5)", "random(n=64,mu=0.5)"}) {
    const Problem p = only(text).problem;
    const Matrix J(p.J);
    for (Index i = 0; i < p.rows(); ++i) {
      if (p.is_equality(i) || p.is_tangent(i)) continue;
      ASSERT_EQ(p.tangents(i), 2) << text;
      const Matrix rows = J.middleRows(i, 3), gram = rows * rows.transpose();
      EXPECT_EQ(gram, Matrix(Matrix::Identity(3, 3) * gram(0, 0))) << text << ", row " << i;
    }
  }
}

// A pyramid whose edges lie in the plane of what happens holds what Coulomb's cone holds.
double motion(const std::string& text) {
  const Problem p = under(Law::pyramid, only(text).problem);
  const Solution s = make_solver("dual_active_set").solve(p, {.tolerance = 1e-10});
  EXPECT_EQ(s.status, Status::solved) << text << ": " << s.message;
  return s.z.size() == p.size() ? s.z.cwiseAbs().maxCoeff() : std::numeric_limits<double>::quiet_NaN();
}

struct Limit {
  std::string rests, moves;
};

class Limits : public testing::TestWithParam<Limit> {};

TEST_P(Limits, AreWhereTheBookHasThem) {
  EXPECT_LE(motion(GetParam().rests), 1e-8) << GetParam().rests;
  EXPECT_GE(motion(GetParam().moves), 1e-3) << GetParam().moves;
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, Limits,
    testing::Values(Limit{"incline(slope=0.75,mu=0.751)", "incline(slope=0.75,mu=0.749)"},
                    Limit{"crate(push=0.499,mu=0.5)", "crate(push=0.501,mu=0.5)"},
                    Limit{"crate(push=0.499,tall=2,mu=1)", "crate(push=0.501,tall=2,mu=1)"},
                    Limit{"pinch(squeeze=1.001,mu=0.5)", "pinch(squeeze=0.999,mu=0.5)"},
                    Limit{"ladder(slope=0.751,mu=0.5)", "ladder(slope=0.749,mu=0.5)"},
                    Limit{"peg(load=8,mu=0.563)", "peg(load=8,mu=0.562)"},
                    Limit{"belt(speed=1,carried=1)", "belt(speed=1)"},
                    Limit{"ball(speed=1,spin=2)", "ball(speed=1)"},  //
                    Limit{"arch(mu=0.75)", "arch"}, Limit{"dome(rings=2,sectors=6)", "dome(rings=2,sectors=6,mu=0)"},
                    Limit{"cards", "cards(mu=0)"},
                    Limit{"cards(storeys=1,lean=0.25,mu=0.126)", "cards(storeys=1,lean=0.25,mu=0.124)"},
                    Limit{"heap", "heap(mu=0)"}));

}  // namespace
}  // namespace zwang
