#include <gtest/gtest.h>

#include <thread>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/solvers/friction/solution_derivative.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

const SolveOptions tight{.tolerance = 1e-13};
const Vector none;

Vector random_vector(Index size, unsigned seed) {
  std::srand(seed);
  return Vector::Random(size);
}

double length(const Problem& p, const Vector& v) { return std::sqrt(v.dot(p.M * v)); }

struct Case {
  const char *scene, *solver;
  Law law;
};
class Smooth : public testing::TestWithParam<Case> {};

// Central differences of solves, whose error is near 1e-13 / h; larger steps change the modes of a hand.
TEST_P(Smooth, DerivativesAreThoseOfDifferences) {
  const auto [scene, solver, law] = GetParam();
  const Problem p = under(law, make_scenes(scene).at(0).problem);
  AnySolver method = make_solver(solver);
  const Solution at = method.solve(p, tight);
  SolutionDerivative of(p, at.z, at.lambda);
  ASSERT_TRUE(of.ties.empty());
  ASSERT_LE(of.off, 1e-9 * of.motion);
  Vector dc = random_vector(p.rows(), 2);
  for (Index i = 0; i < p.rows(); ++i) dc[i] *= p.is_equality(i) ? 0 : of.motion;
  const Vector dz_u = of.motion * random_vector(p.size(), 1), force = of.motion * random_vector(p.size(), 3);
  const Vector by_force = Eigen::MatrixXd(p.M).llt().solve(force);
  const SolutionDerivative::Change change = of.along(dz_u, force, -dc, none);
  EXPECT_TRUE(change.is_settled);
  constexpr double h = 1e-8;
  const auto moved = [&](double by) {
    Problem q = p;
    q.z_u += by * (dz_u + by_force);
    q.c += by * dc;
    return method.solve(q, tight).z;
  };
  const Vector difference = (moved(h) - moved(-h)) / (2 * h);
  EXPECT_LE(length(p, change.z - difference), 1e-4 * length(p, difference));
}

// g'(dz) of a direction is the direction's product with what comes back of g.
TEST_P(Smooth, TheWayBackIsTheTransposed) {
  const auto [scene, solver, law] = GetParam();
  const Problem p = under(law, make_scenes(scene).at(0).problem);
  const Solution at = make_solver(solver).solve(p, tight);
  SolutionDerivative of(p, at.z, at.lambda);
  const Vector dz_u = random_vector(p.size(), 4), g = random_vector(p.size(), 5);
  const Vector dz = of.along(dz_u, none, none, none).z;
  EXPECT_NEAR(g.dot(dz), dz_u.dot(of.back(g, none).z_u), 1e-10 * g.norm() * dz.norm());
}

INSTANTIATE_TEST_SUITE_P(Scenes, Smooth,
                         testing::Values(Case{"hand(contacts=16)", "dual_active_set", Law::frictionless},
                                         Case{"hand(contacts=16,mu=0.5)", "cone", Law::convex},
                                         Case{"hand(contacts=16,mu=0.5)", "cone", Law::coulomb},
                                         Case{"pile(spheres=40,mu=0.5)", "cone", Law::convex}));

// What a solver left of a hand's joints, or of those of a hand that is another by one entry, changes no bit.
TEST(SolutionDerivativeByTheFormOfTheSolve, HasTheSameBits) {
  for (const char* scene : {"hand(contacts=16)", "hand(contacts=64)", "chain"}) {
    const Problem p = make_scenes(scene).at(0).problem;
    Problem other = p;
    other.J.coeffs()[0] += 0x1p-40;
    const Vector dz_u = random_vector(p.size(), 6);
    Vector alone, after_solve, again, after_other;
    const Solution at = make_solver("dual_active_set").solve(p, tight);
    const auto derive = [&](Vector& dz) {
      dz = SolutionDerivative(p, at.z, at.lambda).along(dz_u, none, none, none).z;
    };
    const auto solve = [](const Problem& problem) {
      SolveOptions leaving = tight;
      leaving.form = &SolutionDerivative::form();
      return make_solver("dual_active_set").solve(problem, leaving);
    };
    std::thread([&] { derive(alone); }).join();  // a thread begins without a form
    std::thread([&] {
      EXPECT_EQ(solve(p).z, at.z);
      EXPECT_TRUE(SolutionDerivative::form().take(p));
      derive(after_solve);
      derive(again);
      solve(other);
      EXPECT_FALSE(SolutionDerivative::form().take(p));
      derive(after_other);
    }).join();
    EXPECT_EQ(after_solve, alone) << scene;
    EXPECT_EQ(again, alone) << scene;
    EXPECT_EQ(after_other, alone) << scene;
  }
}

// A block rests on two walls without pushing one of them: x >= 0 pushes, y >= 0 is a tie.
Problem corner() {
  Problem p{.M = Matrix::Identity(2, 2).sparseView(), .z_u = Vector::Zero(2), .law = Law::frictionless};
  p.z_u[0] = -1;
  p.J = Matrix::Identity(2, 2).sparseView();
  p.c = Vector::Zero(2);
  p.kind.assign(2, RowKind::inequality);
  p.key.resize(2);
  return p;
}

TEST(SolutionDerivativeAtATie, TheRowOpensOrHolds) {
  const Problem p = corner();
  SolutionDerivative of(p, Vector::Zero(2), Vector::Unit(2, 0));
  ASSERT_EQ(of.ties, std::vector<Index>{1});
  for (const double way : {2.0, -2.0}) {
    const SolutionDerivative::Change change = of.along(Vector::Unit(2, 0) + way * Vector::Unit(2, 1), none, none, none);
    EXPECT_TRUE(change.is_settled);
    EXPECT_NEAR(change.z[0], 0, 1e-15);
    EXPECT_NEAR(change.z[1], std::max(0.0, way), 1e-15);
    EXPECT_NEAR(change.lambda[1], std::max(0.0, -way), 1e-15);
  }
}

TEST(SolutionDerivativeOfASharedLoad, HasNoTiesAndIsThatOfDifferences) {
  for (const char* scene : {"stack(boxes=3)", "tower(boxes=8)", "wall(boxes=10)", "wall(boxes=100)"}) {
    SCOPED_TRACE(scene);
    const Problem p = make_scenes(scene).at(0).problem;
    AnySolver method = make_solver("dual_active_set");
    const Solution at = method.solve(p, tight);
    ASSERT_TRUE((at.lambda.array() == 0).any());
    SolutionDerivative of(p, at.z, at.lambda);
    EXPECT_TRUE(of.ties.empty());
    const Vector dz_u = of.motion * random_vector(p.size(), 6), z_bar = random_vector(p.size(), 7);
    const SolutionDerivative::Change change = of.along(dz_u);
    EXPECT_FALSE(change.is_unique);
    constexpr double h = 1e-6;
    Problem q = p;
    q.z_u += h * dz_u;
    const Vector difference = (method.solve(q, tight).z - at.z) / h;
    EXPECT_LE(length(p, change.z - difference), 1e-7 * length(p, dz_u));
    EXPECT_NEAR(of.back(z_bar, none).z_u.dot(dz_u), z_bar.dot(change.z), 1e-10 * z_bar.norm() * dz_u.norm());
  }
}

// Two rows that are one, and one that touches; then two that leave no room between them, without a load.
TEST(SolutionDerivativeOfASharedLoad, LeavesTheTiesThatCannotPush) {
  Problem p = corner();
  p.J = Eigen::MatrixXd{{1, 0}, {1, 0}, {0, 1}}.sparseView();
  p.c = Vector::Zero(3);
  p.kind.assign(3, RowKind::inequality);
  p.key.resize(3);
  SolutionDerivative of(p, Vector::Zero(2), Vector::Unit(3, 0));
  EXPECT_EQ(of.ties, std::vector<Index>{2});
  EXPECT_EQ(of.rows, (VectorX<Index>(3) << 0, 1, 2).finished());
  EXPECT_EQ(of.along(Vector::Ones(2)).z, Vector::Unit(2, 1));
  p.J = Eigen::MatrixXd{{1, 0}, {-1, 0}, {0, 1}}.sparseView();
  p.z_u = Vector::Unit(2, 1);
  SolutionDerivative between(p, Vector::Unit(2, 1), Vector::Zero(3));
  EXPECT_TRUE(between.ties.empty());
  EXPECT_EQ(between.along(Vector::Ones(2)).z, Vector::Unit(2, 1));
}

TEST(SolutionDerivativeOfBadInput, IsRefusedInOneLine) {
  const Problem p = corner();
  SolutionDerivative of(p, Vector::Zero(2), Vector::Unit(2, 0));
  const auto of_size = [](Index size) -> Vector { return Vector::Ones(size); };
  const auto refused = [](const auto& call) {
    try {
      call();
    } catch (const std::invalid_argument& bad) {
      return std::string(bad.what());
    }
    return std::string();
  };
  for (const std::string& line :
       {refused([&] { SolutionDerivative(p, of_size(3), of_size(2)); }),
        refused([&] { SolutionDerivative(p, of_size(2), of_size(1)); }),
        refused([&] { of.along(of_size(1), none, none, none); }),
        refused([&] { of.along(none, of_size(3), none, none); }),
        refused([&] { of.along(none, none, of_size(5), none); }),
        refused([&] { of.along(none, none, none, of_size(1)); }), refused([&] { of.back(of_size(3), none); }),
        refused([&] { of.back(of_size(2), of_size(3)); })}) {
    EXPECT_FALSE(line.empty());
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
}

// J_n M^-1 (J_n - mu J_t)' = 2 gap: a contact that slides, and jams where it is zero.
TEST(SolutionDerivativeOfASlide, IsRefusedWhereItAllButJams) {
  for (const double gap : {0.0, 1e-12, 1e-9, 3e-8, 1e-7, 1e-6, 1e-3}) {
    SCOPED_TRACE(gap);
    Problem p{.M = Eigen::MatrixXd{{3, 1}, {1, 2}}.sparseView(), .law = Law::coulomb};
    const double mu = 1 - gap;
    const Eigen::Vector2d normal(0, 1), tangent(2, 0), z(0, 0), lambda(3, -3 * mu);
    p.z_u = z - 3 * (normal - mu * tangent);
    p.J = (Eigen::MatrixXd(2, 2) << (p.M * normal).transpose(), (p.M * tangent).transpose()).finished().sparseView();
    p.c = Eigen::Vector2d(0, -1);
    p.kind = {RowKind::inequality, RowKind::tangent};
    p.key.resize(2);
    p.mu = Eigen::Vector2d(mu, 0);
    SolutionDerivative of(p, z, lambda);
    try {
      const Vector dz = of.along(none, none, Eigen::Vector2d(-1, 0)).z;
      EXPECT_GE(gap, 1e-7);
      const double right = -2 * mu / (2 - 2 * mu);
      EXPECT_NEAR(dz[0], right, 1e-9 * std::abs(right));
    } catch (const std::invalid_argument&) {
      EXPECT_LT(gap, 1e-6);
    }
  }
}

TEST(SolutionDerivativeOfABox, OfNoUnknownsIsEmpty) {
  Problem nothing;
  nothing.M.resize(0, 0);
  const Problem p = make_scenes("tower(boxes=1)").at(0).problem;
  const Solution at = make_solver("dual_active_set").solve(p, tight);
  SolutionDerivative(p, at.z, at.lambda).along(Vector::Ones(p.size()), none, none, none);  // leaves its factor behind
  EXPECT_EQ(SolutionDerivative(nothing, Vector(), Vector()).along(none, none, none, none).z.size(), 0);
}

TEST(SolutionDerivativeOfABox, SaysThatForcesAreNotUnique) {
  const Problem p = make_scenes("tower(boxes=1)").at(0).problem;
  const Solution at = make_solver("dual_active_set").solve(p, tight);
  SolutionDerivative of(p, at.z, at.lambda);
  EXPECT_FALSE(of.along(Vector::Ones(p.size()), none, none, none).is_unique);
}

}  // namespace
}  // namespace zwang
