#include "tests/constraints/conformance.h"

#include <gtest/gtest.h>

#include <zwang/constraints/ball_joint.h>
#include <zwang/constraints/contact.h>
#include <zwang/constraints/distance.h>
#include <zwang/constraints/joint_limit.h>
#include <zwang/constraints/prismatic_joint.h>
#include <zwang/constraints/revolute_joint.h>
#include <zwang/constraints/rope.h>
#include <zwang/constraints/universal_joint.h>
#include <zwang/constraints/weld.h>
#include <zwang/core/model/assemble.h>
#include "docs/leash.h"

namespace zwang::conformance {
namespace {

// A constraint of the type list, with data that hides nothing (no zeros, no symmetry). Bodies a and b are 0 and 1.
template <auto make>
struct Example {
  static auto constraint() { return make(); }
};

using Bodies = std::array<BodyId, 2>;
constexpr Bodies ab{0, 1};
const Vec3 p{0.3, -0.2, 0.5}, r{-0.4, 0.25, 0.1}, u = Vec3(2, -1, 2) / 3, v = Vec3(1, 2, 2) / 3,
                                                  w = Vec3(1, 2, 0).normalized();
const Mat3 turned = retract<double>({}, Vec<double, 6>(0, 0, 0, 0.4, -0.3, 0.7)).rotation;

// The type list: a new constraint is one line.
// clang-format off
using Constraints = ::testing::Types<
    Example<[] { return Contact{ab, p, r, contact_frame(u), 0.5}; }>,
    Example<[] { return BallJoint{ab, p, r}; }>,
    Example<[] { return UniversalJoint{ab, p, r, u, v}; }>,
    Example<[] { return RevoluteJoint{ab, p, r, u, v}; }>,
    Example<[] { return PrismaticJoint{ab, p, r, u, turned}; }>,
    Example<[] { return Weld{ab, p, r, turned}; }>,
    Example<[] { return Distance{ab, p, p, 1.5}; }>,
    Example<[] { return Rope{{ab, p, p, 1.5}}; }>,
    Example<[] { return JointLimit{ab, u, v, w, 1.2, Side::upper}; }>,
    Example<[] { return Leash{ab, p, r, 1.5}; }>>;
// clang-format on

template <class E>
class Conformance : public ::testing::Test {
 protected:
  using C = decltype(E::constraint());

  Conformance() { std::srand(1); }

  void expect(const Finding& found) {
    std::puts(found.line.c_str());
    EXPECT_TRUE(found.ok) << found.fault;
  }

  const C c = E::constraint();
};

struct ConstraintName {
  template <class E>
  static std::string GetName(int) {
    return decltype(E::constraint())::name;
  }
};
TYPED_TEST_SUITE(Conformance, Constraints, ConstraintName);

TYPED_TEST(Conformance, DerivativesMatchCentralDifferences) {
  for (const Finding& found : derivatives(this->c)) this->expect(found);
}

TYPED_TEST(Conformance, RowsAreFiniteAtDegeneratePoses) { this->expect(finite(this->c)); }

TYPED_TEST(Conformance, RowsAreInvariantUnderARigidMotionOfTheWorld) { this->expect(frames(this->c)); }

TYPED_TEST(Conformance, RowsPushTowardWhatIsAllowed) { this->expect(sign(this->c)); }

TYPED_TEST(Conformance, OnlyTheColumnsOfItsBodiesAreTouched) {
  using C = typename TestFixture::C;
  Scene scene;
  for (int b = 0; b < 5; ++b) scene.add(Body{.pose = random_pose(2)});
  C c = this->c;
  c.bodies = {3, 1};
  if constexpr (HasActive<C>) {  // look for poses at which it acts
    for (int k = 0; k < 100 && !c.active(scene.bodies[3].pose, scene.bodies[1].pose); ++k)
      scene.bodies[1].pose = random_pose(2);
  }
  scene.add(c);
  Problem problem;
  Assembler{}.assemble(scene, Vector::Zero(30), {}, problem);
  Index slips = 0;
  if constexpr (HasSlip<C>) slips = 2;
  ASSERT_EQ(problem.rows(), C::rows + slips);
  const Matrix rows(problem.J), J = rows.topRows(C::rows);
  for (const Index other : {0, 2, 4}) EXPECT_TRUE(rows.middleCols(6 * other, 6).isZero(0)) << "body " << other;
  const auto linear = linearize(c, {scene.bodies[3].pose, scene.bodies[1].pose});
  EXPECT_EQ(J.middleCols(18, 6), linear.jacobian.leftCols(6));
  EXPECT_EQ(J.middleCols(6, 6), linear.jacobian.rightCols(6));
  for (Index i = 0; i < problem.rows(); ++i) EXPECT_EQ(problem.is_equality(i), C::kind == RowKind::equality);
}

// The test tested: a wrong derivative is found, and the message says where.
struct WrongRope : Rope {
  Mat<double, 1, 12> jacobian(const Pose<double>& a, const Pose<double>& b) const {
    Mat<double, 1, 12> J = Rope::jacobian(a, b);
    J(0, 10) = -J(0, 10);
    return J;
  }
};

TEST(ConformanceMessage, NamesRowBodyAxisAndBothValuesOfAWrongDerivative) {
  const WrongRope rope{{{ab, p, r, 1.5}}};
  Poses<double> q(2);
  q[1].position = {1, 2, 3};
  const Difference d = compare(linearize(rope, {q[0], q[1]}).jacobian, central_differences(rope, q));
  EXPECT_GT(d.relative, 1e-3);
  EXPECT_EQ(d.place, "row 0, body b, angular y");
  EXPECT_DOUBLE_EQ(d.found, -d.expected);
  std::ostringstream both;
  both.precision(17);
  both << "at row 0, body b, angular y it gives " << d.found << ", the differences give " << d.expected;
  EXPECT_EQ(both_values(d), both.str());
  EXPECT_FALSE(check(rope));
  EXPECT_TRUE(check(Rope{{ab, p, r, 1.5}}));
}

}  // namespace
}  // namespace zwang::conformance
