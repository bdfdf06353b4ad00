#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <zwang/core/problem/instance.h>
#include <zwang/core/problem/islands.h>
#include <zwang/core/problem/law.h>

namespace zwang {
namespace {

// A body of six unknowns with a joint row, a contact of normal e_3 and tangents e_1, e_2, and a limit.
Problem block(double mu) {
  Problem p{.name = "block", .z_u = Vector::LinSpaced(6, 1, 6)};
  p.M.resize(6, 6);
  p.M.setIdentity();
  p.J.resize(5, 6);
  p.J.insert(0, 5) = 1;
  p.J.insert(1, 2) = 1;
  p.J.insert(2, 0) = 1;
  p.J.insert(3, 1) = 1;
  p.J.insert(4, 4) = 1;
  p.J.makeCompressed();
  p.c = Vector::LinSpaced(5, 10, 14);
  p.kind = {RowKind::equality, RowKind::inequality, RowKind::tangent, RowKind::tangent, RowKind::inequality};
  p.key = {{1, 0}, {2, 0}, {2, 1}, {2, 2}, {3, 0}};
  p.mu = Vector::Zero(5);
  p.mu[1] = mu;
  p.law = Law::coulomb;
  return p;
}

TEST(Law, FrictionlessLeavesTangentRowsOut) {
  const Problem p = under(Law::frictionless, block(0.5));
  EXPECT_EQ(p.rows(), 3);
  EXPECT_FALSE(p.has_tangents());
  EXPECT_EQ(p.law, Law::frictionless);
  EXPECT_EQ(p.c, (Vector(3) << 10, 11, 14).finished());
  EXPECT_EQ(bad_input(p), "");
}

TEST(Law, PyramidHasTwoEdgesATangent) {
  const Problem p = under(Law::pyramid, block(0.5));
  ASSERT_EQ(p.rows(), 6);
  EXPECT_EQ(p.law, Law::pyramid);
  EXPECT_FALSE(p.has_tangents());
  Matrix edges(4, 3);
  edges << 0.5, 0, 1, -0.5, 0, 1, 0, 0.5, 1, 0, -0.5, 1;
  EXPECT_EQ(Matrix(p.J).block(1, 0, 4, 3), edges);
  EXPECT_EQ(p.c.segment(1, 4), (Vector(4) << 17, 5, 17.5, 4.5).finished());
  EXPECT_EQ(p.key[4], (RowKey{2, 3}));
  EXPECT_EQ(bad_input(p), "");
}

TEST(Law, ConvexAndCoulombKeepTheRows) {
  for (const Law law : {Law::convex, Law::coulomb}) {
    const Problem p = under(law, block(0.5));
    EXPECT_EQ(p.law, law);
    EXPECT_EQ(Matrix(p.J), Matrix(block(0.5).J));
    EXPECT_EQ(p.mu, block(0.5).mu);
    EXPECT_EQ(bad_input(p), "");
  }
}

TEST(Law, NoFrictionIsNoTangentRows) {
  for (const Law law : {Law::frictionless, Law::pyramid, Law::convex, Law::coulomb}) {
    const Problem p = under(law, block(0));
    EXPECT_EQ(p.rows(), 3);
    EXPECT_FALSE(p.has_tangents());
  }
}

TEST(Law, RowsKeepTheirNames) {
  Instance instance{.problem = block(0.5)};
  for (const char* name : {"joint/j", "contact/a [0]", "contact/a [1]", "contact/a [2]", "limit/l"})
    instance.origin.push_back(parse_row_origin(name));
  instance.reference = Reference{};
  EXPECT_TRUE(under(Law::coulomb, instance).reference);
  const Instance pyramid = under(Law::pyramid, instance);
  EXPECT_FALSE(pyramid.reference);
  EXPECT_EQ(row_name(pyramid, 3), "friction_pyramid/a [2]");
  EXPECT_EQ(row_name(pyramid, 5), "limit/l");
}

TEST(Law, WordsAreRead) {
  for (const Law law : {Law::frictionless, Law::pyramid, Law::convex, Law::coulomb})
    EXPECT_EQ(parse_law(to_string(law)), law);
  EXPECT_THROW(parse_law("Coulomb"), std::invalid_argument);
}

TEST(Law, BadFrictionIsNamed) {
  const auto message = [](auto&& change) {
    Problem p = block(0.5);
    change(p);
    return bad_input(p);
  };
  EXPECT_EQ(message([](Problem& p) { p.mu[1] = -1; }), "mu(1) is -1; expected a number >= 0");
  EXPECT_NE(message([](Problem& p) { p.mu[1] = NAN; }).find("mu(1) is nan"), std::string::npos);
  EXPECT_NE(message([](Problem& p) { p.mu[1] = INFINITY; }).find("mu(1) is inf"), std::string::npos);
  EXPECT_EQ(message([](Problem& p) { p.mu[4] = 1; }), "row 4 has mu > 0 and no tangent rows");
  EXPECT_EQ(message([](Problem& p) { p.kind[1] = RowKind::equality; }),
            "row 2 is a tangent row without an inequality row before it");
  EXPECT_EQ(message([](Problem& p) { p.kind[4] = RowKind::tangent; }), "row 1 has 3 tangent rows; expected 1 or 2");
  EXPECT_EQ(message([](Problem& p) { p.mu.resize(0); }), "row 2 is a tangent row, but there are no mu");
  EXPECT_EQ(message([](Problem& p) { p.law = Law::pyramid; }),
            "there are tangent rows, but the law is pyramid; expected convex or coulomb");
  EXPECT_EQ(message([](Problem& p) { p.c[2] = -INFINITY; }), "c(2) is not a finite number");
}

// Two bodies that share no row: one contact's normal row stands on the first, its tangent row on the second.
TEST(Law, AContactIsOneIsland) {
  Problem p{.name = "apart", .z_u = Vector::Zero(12)};
  p.M.resize(12, 12);
  p.M.setIdentity();
  p.J.resize(2, 12);
  p.J.insert(0, 2) = 1;
  p.J.insert(1, 7) = 1;
  p.J.makeCompressed();
  p.c = Vector::Zero(2);
  p.kind = {RowKind::inequality, RowKind::tangent};
  p.key = {{1, 0}, {1, 1}};
  p.mu = (Vector(2) << 0.5, 0).finished();
  p.law = Law::coulomb;
  Islands islands;
  islands.split(p, 6);
  EXPECT_EQ(islands.all().size(), 1U);
  EXPECT_EQ(islands.all()[0].problem.mu, p.mu);
  p.kind[1] = RowKind::inequality;
  p.mu.resize(0);
  p.law = Law::frictionless;
  islands.split(p, 6);
  EXPECT_EQ(islands.all().size(), 2U);
}

// A solver that reads no tangent rows never sees one.
struct ReadsNone {
  static constexpr std::string_view name = "reads_none";
  void solve(const Problem& p, const SolveOptions&, Solution& out) {
    out.reset(p.size(), p.rows());
    out.status = Status::solved;
  }
};
struct ReadsConvex : ReadsNone {
  static constexpr std::array laws{Law::convex};
};

// Answers with z and lambda of these sizes, full of one number.
struct AnswersWith {
  static constexpr std::string_view name = "answers_with";
  Index n, m;
  double entry;
  void solve(const Problem&, const SolveOptions&, Solution& out) {
    out.z.setConstant(n, entry);
    out.lambda.setConstant(m, entry);
    out.status = Status::solved;
  }
};

TEST(Solver, AnAnswerOfAnotherSizeOrBeyondDoublesIsNone) {
  const Problem p = under(Law::frictionless, block(0.5));
  const Index n = p.size(), m = p.rows();
  const auto message = [&](Index z, Index lambda, double entry) {
    AnySolver solver = AnswersWith{z, lambda, entry};
    const Solution s = solver.solve(p);
    return s.status == Status::solved ? "solved" : s.message;
  };
  EXPECT_EQ(message(n, m, 1), "solved");
  EXPECT_EQ(message(n, 0, 1), "solved");
  EXPECT_EQ(message(n + 1, m, 1), "z has 7 entries, expected 6");
  EXPECT_EQ(message(n, m + 3, 1), "lambda has 6 entries, expected 3");
  EXPECT_EQ(message(n, m, infinity), "z holds a number that does not fit doubles");
}

TEST(Law, SolversSeeTheLawsTheyRead) {
  AnySolver none = ReadsNone{}, convex = ReadsConvex{};
  EXPECT_EQ(none.solve(block(0.5)).status, Status::unsupported);
  EXPECT_EQ(none.supports(block(0.5)),
            "it does not solve problems with friction under the law coulomb (./zwang solvers lists the laws of each)");
  EXPECT_EQ(convex.solve(block(0.5)).status, Status::unsupported);
  EXPECT_EQ(convex.solve(under(Law::convex, block(0.5))).status, Status::solved);
  EXPECT_EQ(none.solve(under(Law::pyramid, block(0.5))).status, Status::solved);
}

}  // namespace
}  // namespace zwang
