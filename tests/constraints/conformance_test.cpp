#include "tests/constraints/conformance.h"

#include <gtest/gtest.h>

#include <iostream>

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
  static constexpr double tolerance = 1e-12;  // relative to the row's largest entry

  Conformance() { std::srand(1); }

  void expect_derivatives_match(const std::vector<PosesOf<C, double>>& configurations, const std::string& where) {
    Difference automatic, analytic;
    for (const auto& q : configurations) {
      const Jacobian<C> truth = central_differences(c, q);
      const auto keep_worse = [&](Difference& worst, const Jacobian<C>& J) {
        ASSERT_TRUE(J.allFinite()) << name << " " << where << ":\n" << J;
        if (const Difference d = compare(J, truth); d.relative > worst.relative) worst = d;
      };
      keep_worse(automatic, differentiate(c, q).jacobian);
      keep_worse(analytic, linearize(c, q).jacobian);
    }
    report("jacobian", "automatic vs central differences, " + where, automatic);
    if (HasJacobian<C>) report("jacobian", "analytic vs central differences, " + where, analytic);
  }

  void report(const std::string& aspect, const std::string& what, const Difference& d) {
    const bool ok = d.relative <= tolerance;
    std::cout << line(name + "." + aspect, what, d.relative, ok, d.place) << "\n";
    EXPECT_TRUE(ok) << name << ": " << what << ": " << both_values(d);
  }
  void report(const std::string& aspect, const std::string& what, double figure, double allowed = tolerance) {
    std::cout << line(name + "." + aspect, what, figure, figure <= allowed) << "\n";
    EXPECT_LE(figure, allowed) << name << ": " << what;
  }

  std::vector<PosesOf<C, double>> configurations(int count, double reach) {
    std::vector<PosesOf<C, double>> all;
    for (int k = 0; k < count; ++k) all.push_back(random_poses<C>(reach));
    return all;
  }

  const C c = E::constraint();
  const std::string name = C::name;
};

struct ConstraintName {
  template <class E>
  static std::string GetName(int) {
    return decltype(E::constraint())::name;
  }
};
TYPED_TEST_SUITE(Conformance, Constraints, ConstraintName);

TYPED_TEST(Conformance, DerivativesMatchCentralDifferencesAtOrdinaryPoses) {
  this->expect_derivatives_match(this->configurations(10, 2), "bodies 1 m apart");
}

TYPED_TEST(Conformance, DerivativesMatchCentralDifferencesAtLargeValues) {
  this->expect_derivatives_match(this->configurations(10, 2e6), "bodies 1e6 m apart");
}

TYPED_TEST(Conformance, DerivativesMatchCentralDifferencesWhereTheValueIsTiny) {
  std::vector<PosesOf<typename TestFixture::C, double>> all;
  for (int k = 0; k < 5; ++k) all.push_back(nearly_satisfied(this->c, 1e-12));
  this->expect_derivatives_match(all, "values of 1e-12");
}

// Bodies on top of each other, half turns: where norms, angles and rotation vectors lose their gradients.
TYPED_TEST(Conformance, RowsAreFiniteAtDegeneratePoses) {
  using C = typename TestFixture::C;
  for (const Vec3& half_turn : {Vec3(0, 0, 0), Vec3(M_PI, 0, 0), Vec3(0, M_PI, 0), Vec3(0, 0, M_PI)})
    for (const Pose<double>& first : {Pose<double>{}, random_pose(2)}) {
      PosesOf<C, double> q;
      q.fill(first);
      Vec<double, 6> twist;
      twist << Vec3::Zero(), half_turn;
      q.back() = retract(first, twist);
      const auto linear = linearize(this->c, q);
      EXPECT_TRUE(linear.value.allFinite()) << this->name << ": " << linear.value.transpose();
      EXPECT_TRUE(linear.jacobian.allFinite()) << this->name << ":\n" << linear.jacobian;
    }
}

// The world turned and moved: an inequality's rows and values stay what they are, seen from the turned world; those of
// an equality may be mixed among themselves by a rotation (a ball joint's three rows are world axes), so that J'J, J'v
// and v'v stay.
TYPED_TEST(Conformance, RowsAreInvariantUnderARigidMotionOfTheWorld) {
  using C = typename TestFixture::C;
  double worst = 0;
  for (const auto& q : this->configurations(10, 2)) {
    const Pose<double> world = random_pose(2);
    PosesOf<C, double> there;
    for (std::size_t b = 0; b < q.size(); ++b)
      there[b] = {world.rotation * q[b].position + world.position, world.rotation * q[b].rotation};
    const auto here = linearize(this->c, q);
    auto seen = linearize(this->c, there);
    for (int k = 0; k < 2 * arity<C>; ++k)
      seen.jacobian.template middleCols<3>(3 * k) =
          (seen.jacobian.template middleCols<3>(3 * k) * world.rotation).eval();
    Matrix H(C::rows, 6 * arity<C> + 1), S(C::rows, 6 * arity<C> + 1);
    H << here.jacobian, here.value;
    S << seen.jacobian, seen.value;
    const Matrix change =
        C::kind == RowKind::inequality ? Matrix(S - H) : Matrix(S.transpose() * S - H.transpose() * H);
    worst = std::max(worst, change.cwiseAbs().maxCoeff() / std::max(1., H.squaredNorm()));
  }
  this->report("frames", "invariant under a rigid motion of the world", worst);
}

// A short move along a row's gradient raises the value of an inequality; along the correction, it brings the value of
// an equality nearer to zero, by the part that was walked.
TYPED_TEST(Conformance, RowsPushTowardWhatIsAllowed) {
  using C = typename TestFixture::C;
  constexpr double part = 1e-6;
  double worst = 0;
  for (const auto& q : this->configurations(10, 2)) {
    const auto linear = linearize(this->c, q);
    for (int row = 0; row < C::rows; ++row) {
      const Vec<double, 6 * arity<C>> along = linear.jacobian.row(row).transpose();
      if (C::kind == RowKind::inequality && along.norm() > 1e-3) {
        const auto after = evaluate(this->c, moved<C>(q, Vec<double, 6 * arity<C>>(part * along)));
        const double slope = (after[row] - linear.value[row]) / (part * along.squaredNorm());
        worst = std::max(worst, std::abs(slope - 1));
      }
    }
    if (C::kind == RowKind::equality) {
      const auto after = evaluate(this->c, moved<C>(q, Vector(part * correction(this->c, q))));
      worst = std::max(worst, std::abs((linear.value.norm() - after.norm()) / (part * linear.value.norm()) - 1));
    }
  }
  this->report("sign",
               C::kind == RowKind::inequality ? "inequality: value >= 0 is allowed, row pushes toward it"
                                              : "equality: value = 0 is allowed, rows pull toward it",
               worst, 1e-3);
}

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
  PosesOf<WrongRope, double> q;
  q[1].position = {1, 2, 3};
  const Difference d = compare(linearize(rope, q).jacobian, central_differences(rope, q));
  EXPECT_GT(d.relative, 1e-3);
  EXPECT_EQ(d.place, "row 0, body b, angular y");
  EXPECT_DOUBLE_EQ(d.found, -d.expected);
  std::ostringstream both;
  both.precision(17);
  both << "at row 0, body b, angular y it gives " << d.found << ", the differences give " << d.expected;
  EXPECT_EQ(both_values(d), both.str());
}

}  // namespace
}  // namespace zwang::conformance
