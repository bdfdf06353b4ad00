#include <zwang/core/model/assemble.h>

#include <gtest/gtest.h>

#include <zwang/bench/timing/allocations.h>
#include <zwang/constraints/ball_joint.h>
#include <zwang/constraints/contact.h>
#include <zwang/constraints/joint_limit.h>
#include <zwang/constraints/prismatic_joint.h>
#include <zwang/constraints/revolute_joint.h>
#include <zwang/constraints/rope.h>
#include <zwang/core/model/motion.h>

namespace zwang {
namespace {

Body body_at(const Vec3& position, Motion motion = Motion::free) {
  Body body;
  body.pose.position = position;
  body.motion = motion;
  return body;
}

// A soft ball joint, to see what assembly makes of a compliance.
struct SoftBall : BallJoint {
  static constexpr auto name = "soft_ball";
  Vec3 soft = Vec3::Zero();
  Vec3 compliance() const { return soft; }
};
static_assert(Constraint<SoftBall> && HasCompliance<SoftBall>);

// Two boxes jointed to each other, the first hovering 1/4 m over the ground.
struct TwoBodies : ::testing::Test {
  TwoBodies() {
    ground = scene.add(body_at({0, 0, 0}, Motion::fixed));
    a = scene.add(body_at({0, 0, 1}));
    b = scene.add(body_at({2, 0, 1}));
    scene.bodies[1].mass = 2;
    scene.bodies[2].inertia = Vec3(1, 2, 4).asDiagonal();
    scene.add(contact_at(scene.bodies, a, ground, {0.5, 0, 0.25}, Vec3::UnitZ(), 0.25), "a on ground");
    scene.add(BallJoint{{b, a}, {-1, 0, 0}, {1, 0.5, 0}}, "elbow");
    z_u = Vector::Zero(12);
  }
  Scene scene;
  BodyId ground, a, b;
  Vector z_u;
  Assembler assembler;
  Problem problem;
};

TEST_F(TwoBodies, EqualityRowsComeFirstAndRowsAreNamed) {
  assembler.assemble(scene, z_u, {}, problem);
  const std::vector<std::string> names{"ball_joint/elbow [0]", "ball_joint/elbow [1]", "ball_joint/elbow [2]",
                                       "contact/a on ground"};
  std::vector<std::string> written;
  for (const RowOrigin& origin : assembler.origin(scene, problem)) written.push_back(to_string(origin));
  EXPECT_EQ(written, names);
  EXPECT_TRUE(problem.is_equality(0) && problem.is_equality(2) && !problem.is_equality(3));
  EXPECT_EQ(problem.key[0].constraint, problem.key[2].constraint);
  EXPECT_EQ(problem.key[2].row, 2u);
  EXPECT_NE(problem.key[3].constraint, problem.key[2].constraint);
  require_matching_sizes(problem);
  EXPECT_EQ(bad_input(problem), "");
}

TEST_F(TwoBodies, RowsThatShiftingABodyChangesAreLengthsTheOthersAngles) {
  scene = Scene();
  scene.add(body_at({0, 0, 0}, Motion::fixed));
  scene.add(body_at({0, 0, 1}));
  scene.add(body_at({2, 0, 1}));
  scene.add(RevoluteJoint{.bodies = {1, 2}}, "elbow");
  scene.add(PrismaticJoint{.bodies = {0, 1}}, "rail");
  scene.add(JointLimit{.bodies = {1, 2}, .reach = 1}, "lower");
  scene.add(Rope{{{1, 2}}}, "leash");
  scene.add(SoftBall{{{2, 0}}, Vec3(0, 0.5, 0)}, "spring");
  assembler.assemble(scene, z_u, {}, problem);
  std::map<std::string, std::string> units;
  for (const RowOrigin& origin : assembler.origin(scene, problem)) units[origin.type] += origin.unit[0];
  const std::map<std::string, std::string> expected{{"revolute_joint", "mmmrr"},
                                                    {"prismatic_joint", "mmrrr"},
                                                    {"joint_limit", "r"},
                                                    {"rope", "m"},
                                                    {"soft_ball", "mmm"}};
  EXPECT_EQ(units, expected);
}

TEST(RowOrigin, ReadsAsItIsWritten) {
  for (const std::string text : {"contact/box 3 on box 2", "ball_joint/elbow [2]", "row 17", "", "contact/a [b]",
                                 "contact/[3]", "contact/a/b [12]", "contact/a [-1]", "contact/ (a sum)"})
    EXPECT_EQ(to_string(parse_row_origin(text)), text);
  EXPECT_EQ(parse_row_origin("ball_joint/left elbow [2]", "m/s^2"),
            (RowOrigin{"ball_joint", "left elbow", 2, "m/s^2"}));
  EXPECT_EQ(parse_row_origin("contact/a [b]"), (RowOrigin{"contact", "a [b]"}));
  EXPECT_EQ(parse_row_origin("row 17"), (RowOrigin{"row 17"}));
}

TEST(RowOrigin, NamesARowByItsNumberWhereNobodyNamedIt) {
  Instance instance;
  EXPECT_EQ(row_name(instance, 3), "row 3");
  EXPECT_EQ(row_name(instance, -1), "");
  instance.origin = {{"contact", "a"}, {"weld", "b", 5}};
  EXPECT_EQ(row_name(instance, 1), "weld/b [5]");
}

TEST_F(TwoBodies, RowsAreTheConstraintsDerivativesInTheColumnsOfTheirBodies) {
  assembler.assemble(scene, z_u, {}, problem);
  const Matrix J(problem.J);
  const Mat<double, 3, 12> joint =
      BallJoint{{b, a}, {-1, 0, 0}, {1, 0.5, 0}}.jacobian(scene.bodies[2].pose, scene.bodies[1].pose);
  EXPECT_EQ(J.block(0, 6, 3, 6), joint.leftCols(6)) << "body b has the last columns but stands first in the joint";
  EXPECT_EQ(J.block(0, 0, 3, 6), joint.rightCols(6));
  Vector contact = Vector::Zero(12);
  contact.head(6) << 0, 0, 1, 0, -0.5, 0;  // [n, u x n], u = (.5, 0, -.75)
  EXPECT_EQ(J.row(3).transpose(), contact);
  EXPECT_EQ(problem.J.nonZeros(), 3 * 12 + 6) << "the fixed ground has no columns";
}

TEST_F(TwoBodies, MassMatrixHoldsMassAndInertiaInWorldAxes) {
  scene.bodies[2].pose.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // x to y
  assembler.assemble(scene, z_u, {}, problem);
  Vector diagonal(12);
  diagonal << 2, 2, 2, 1, 1, 1, 1, 1, 1, 2, 1, 4;
  EXPECT_EQ(Matrix(problem.M), Matrix(diagonal.asDiagonal()));
}

TEST_F(TwoBodies, OneQuasiStaticStepLandsOnTheJoint) {
  const double dt = 0x1p-6;
  assembler.assemble(scene, z_u, {.dt = dt}, problem);
  EXPECT_EQ(problem.c[1], 0.5 / (dt * dt));  // value = p_b - p_a = -1/2 along y
  EXPECT_EQ(problem.c[3], -0.25 / (dt * dt));
  Vector z = Vector::Zero(12);
  z[7] = problem.c[1];
  integrate(scene, z, dt, Mode::quasi_static);
  EXPECT_EQ(scene.bodies[2].pose.position, Vec3(2, 0.5, 1));
}

TEST_F(TwoBodies, OneDynamicStepLandsOnTheJointWhateverTheVelocity) {
  const double dt = 0x1p-6;
  scene.bodies[1].velocity << 1, 2, 3, 0, 0, 0;
  scene.bodies[2].velocity << -1, 0.5, 0, 0, 0, 0;
  assembler.assemble(scene, z_u, {.dt = dt, .mode = Mode::dynamic}, problem);
  EXPECT_EQ(problem.c[1], 0.5 / (dt * dt) + 1.5 / dt);
  Vector z = Vector::Zero(12);
  z.segment<3>(6) = problem.c.head<3>();
  integrate(scene, z, dt, Mode::dynamic);
  const Pose<double>&pa = scene.bodies[1].pose, &pb = scene.bodies[2].pose;
  EXPECT_EQ(pb.position - Vec3(1, 0, 0), pa.position + Vec3(1, 0.5, 0));
}

TEST_F(TwoBodies, VelocitiesCountAsZeroInTheQuasiStaticMode) {
  assembler.assemble(scene, z_u, {}, problem);
  const Vector c = problem.c;
  scene.bodies[1].velocity << 1, 2, 3, 4, 5, 6;
  assembler.assemble(scene, z_u, {}, problem);
  EXPECT_EQ(problem.c, c);
}

TEST_F(TwoBodies, PrescribedMotionMovesToTheRightHandSide) {
  assembler.assemble(scene, z_u, {}, problem);
  const Matrix J(problem.J);
  const Vector c = problem.c;
  Vec<double, 6> z_b;
  z_b << 1, 2, 4, 8, 16, 32;
  scene.bodies[2].motion = Motion::prescribed;
  scene.bodies[2].prescribed = z_b;
  assembler.assemble(scene, z_u.head(6), {}, problem);
  EXPECT_EQ(problem.size(), 6);
  EXPECT_EQ(Matrix(problem.J), J.leftCols(6));
  EXPECT_EQ(problem.c, Vector(c - J.rightCols(6) * z_b));
}

TEST_F(TwoBodies, ConstraintsBetweenImmovableBodiesAreSkippedAndNamed) {
  scene.bodies[1].motion = Motion::fixed;
  assembler.assemble(scene, z_u.head(6), {}, problem);
  EXPECT_EQ(problem.rows(), 3);
  EXPECT_EQ(assembler.skipped(scene), std::vector<std::string>{"contact/a on ground"});
}

TEST_F(TwoBodies, SoftRowsGetOneUnknownEachWithMassOneOverCompliance) {
  scene.add(SoftBall{{.bodies = {a, b}}, {0.25, 0, 0.5}}, "spring");
  assembler.assemble(scene, z_u, {}, problem);
  ASSERT_EQ(problem.size(), 14);
  const Matrix J(problem.J), M(problem.M);
  EXPECT_EQ(M(12, 12), 4);
  EXPECT_EQ(M(13, 13), 2);
  EXPECT_EQ(J(3, 12), 1);
  EXPECT_EQ(J(5, 13), 1);
  EXPECT_EQ(J.rightCols(2).cwiseAbs().sum(), 2) << "the middle row, of compliance 0, stays hard";
  EXPECT_EQ(bad_input(problem), "");
}

TEST_F(TwoBodies, ASecondAssemblyAllocatesNothingAndGivesTheSameBits) {
  const long start = allocations();
  assembler.assemble(scene, z_u, {}, problem);
  EXPECT_GT(allocations() - start, 0) << "the counter does not count";
  const Problem first = problem;
  const long before = allocations();
  assembler.assemble(scene, z_u, {}, problem);
  EXPECT_EQ(allocations() - before, 0);
  EXPECT_EQ(problem.c, first.c);
  EXPECT_EQ(Matrix(problem.J), Matrix(first.J));
  EXPECT_EQ(Matrix(problem.M), Matrix(first.M));
}

TEST_F(TwoBodies, WrongUseThrowsAndSaysTheSizes) {
  try {
    assembler.assemble(scene, Vector::Zero(6), {}, problem);
    FAIL() << "nothing was thrown";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("z_u has 6 entries, the free bodies need 12"), std::string::npos) << e.what();
  }
  EXPECT_THROW(assembler.assemble(scene, z_u, {.dt = 0}, problem), std::invalid_argument);
  EXPECT_THROW(scene.add(BallJoint{{a, a}}), std::invalid_argument);
  EXPECT_THROW(scene.add(BallJoint{{a, 7}}), std::invalid_argument);
}

// What is no optional member of a constraint, but looks like one.
struct AllButSoft {
  double compliance();
};
struct Hard {};
template <class C>
constexpr bool says_compliance = !requires { &Beside<C>::compliance; };
static_assert(says_compliance<AllButSoft> && !says_compliance<Hard> && require_optional_members<BallJoint>());

TEST_F(TwoBodies, ACopiedSceneAssemblesToTheSameProblem) {
  assembler.assemble(scene, z_u, {}, problem);
  Scene copy = scene;
  Problem other;
  assembler.assemble(copy, z_u, {}, other);
  EXPECT_EQ(other.c, problem.c);
  EXPECT_EQ(Matrix(other.J), Matrix(problem.J));
}

}  // namespace
}  // namespace zwang
