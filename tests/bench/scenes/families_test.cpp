#include <zwang/bench/scenes/families.h>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>

#include <algorithm>
#include <iomanip>
#include <set>
#include <sstream>

#include <zwang/bench/scenes/known_answer.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/referee/measure.h>

namespace zwang {
namespace {

// The reference, handed to the referee as a solver's answer.
Metrics judge(const Instance& in) {
  Solution s;
  s.status = in.reference->feasible ? Status::solved : Status::infeasible;
  s.z = in.reference->z;
  s.lambda = in.reference->lambda;
  s.certificate = in.reference->certificate;
  return measure(in.problem, s, &*in.reference, 1e-13);
}

void expect_true_answer(const Instance& in) {
  SCOPED_TRACE(in.problem.name);
  ASSERT_TRUE(in.reference);
  EXPECT_EQ(bad_input(in.problem), "");
  EXPECT_EQ(in.origin.size(), in.problem.kind.size());
  const Metrics m = judge(in);
  if (!in.reference->feasible) {
    EXPECT_EQ(m.verdict, Verdict::infeasible_proven);
    return;
  }
  EXPECT_LE(m.primal, 4e-16);
  if (in.reference->lambda.size() == 0) return;
  EXPECT_EQ(m.dual, 0);
  EXPECT_LE(m.stationarity, 4e-16);
  EXPECT_LE(m.complementarity, 4e-16);
}

class Family : public testing::TestWithParam<std::string> {};

TEST_P(Family, AnswersMeetTheKktConditionsOfTheStoredDoubles) {
  const std::string range = GetParam()[0] == 'M' ? "(k=0..48)" : "(k=1..45)";
  for (const Instance& in : make_scenes(GetParam() + range)) expect_true_answer(in);
}
INSTANTIATE_TEST_SUITE_P(Atlas, Family,
                         testing::Values("MR", "MR1", "MRC", "NPE", "NPI", "WED", "LOOP", "GAP", "INC", "WEAK"),
                         [](const auto& info) { return info.param; });

// Without its reference, too: the bound of the least singular value holds for rows that are parallel but for 2^-45. Its
// right inverse once came column by column from R'R, whose condition is the square, and nothing was proven from k = 34 on.
TEST(Families, AnswersOfNearlyParallelRowsAreProvenByThemselves) {
  for (const Instance& in : make_scenes("NPE(k=4,14,24,34,44)")) {
    Solution s;
    s.status = Status::solved;
    s.z = in.reference->z;
    s.lambda = in.reference->lambda;
    EXPECT_EQ(measure(in.problem, s, nullptr, 1e-10).verdict, Verdict::solved) << in.problem.name;
  }
}

TEST(Families, SizesHaveExactAnswersToo) {
  for (const Instance& in : make_scenes("MANYF(contacts=4,6,300,1000),CHAIN(links=1,2,64,4096),STK(boxes=1,64,4096),"
                                        "PIVOT(n=1..16),PIVOT(n=1..16,reversed=1),ROW(zero=2)")) {
    expect_true_answer(in);
    EXPECT_EQ(in.reference->bound, 0) << in.problem.name;
  }
}

// Masses 2^80 apart were once coupled so that M was not positive definite once it was rounded. Sizes stay small.
TEST(Families, EveryKnobGoesToItsEnds) {
  constexpr double largest_size = 100;
  for (const SceneEntry& entry : scenes())
    for (const Knob& knob : entry.knobs)
      for (const double end : {knob.low, knob.high}) {
        if (knob.integer && knob.name != "seed" && end > largest_size) continue;
        std::ostringstream scene;
        scene << entry.name << "(" << knob.name << "=" << std::setprecision(17) << end << ")";
        SCOPED_TRACE(scene.str());
        const Problem problem = make_scenes(scene.str()).at(0).problem;
        EXPECT_EQ(bad_input(problem), "");
        EXPECT_TRUE(is_positive_definite(problem.M));
      }
}

TEST(Families, KnobsOutOfRangeOrOrderAreRefused) {
  for (const char* text : {"tower(boxes=nan)", "tower(boxes=0)", "tower(boxes=2.5)", "tower(boxes=1..inf)",
                           "tower(boxes=5..1)", "random(seed=0..1e9)"})
    EXPECT_THROW(make_scenes(text), std::invalid_argument) << text;
}

TEST(Families, KnobsTakeWhatScenesPrints) {
  const auto sha256 = [](const char* text) { return problem_sha256(make_scenes(text).at(0).problem); };
  EXPECT_EQ(sha256("hand(drift=2^-13)"), sha256("hand"));
  EXPECT_EQ(sha256("hand(drift=2^-7)"), sha256("hand(drift=0.0078125)"));
  EXPECT_NE(sha256("hand(drift=2^-7)"), sha256("hand"));
  EXPECT_EQ(make_scenes("tower(boxes=2^1..2^2)").size(), 3u);
  for (const char* text : {"hand(drift=2^)", "hand(drift=2^-7x)", "hand(drift=2^9999)", "hand(drift=3^-7)"})
    EXPECT_THROW(make_scenes(text), std::invalid_argument) << text;
}

TEST(Families, FrictionOfAllScenesIsTheWholeNumber) {
  constexpr double mu = 1. / 3;
  EXPECT_EQ(make_scenes("wall", 1, mu).at(0).problem.mu.maxCoeff(), mu);
}

TEST(Families, ZeroPointsAreFeasible) {
  for (const char* text : {"LOOP(k=60)", "GAP(k=60)", "INC(k=60)", "WEAK(k=60)", "GAP(k=3,feasible=1)"}) {
    const Instance in = make_scenes(text).at(0);
    expect_true_answer(in);
    EXPECT_TRUE(in.reference->feasible) << text;
  }
}

// At delta = 0 the linkage moves: z is the point of its one-dimensional motion nearest to z_u.
TEST(Families, UntiltedLoopMoves) {
  const Instance in = make_scenes("LOOP(k=60)").at(0);
  EXPECT_NEAR(in.reference->z.norm(), 0.5299, 5e-5);
  Eigen::ColPivHouseholderQR<Matrix> rows(Matrix(in.problem.J).rows(), in.problem.size());
  rows.setThreshold(1e-10);
  EXPECT_EQ(in.problem.rows() - rows.compute(Matrix(in.problem.J)).rank(), 3) << "20 rows of rank 17";
  const Vector held = in.problem.M * (in.problem.z_u - in.reference->z);
  EXPECT_NEAR(held.dot(in.reference->z), 0, 1e-14);
}

// A power of two on rows, lengths or offsets rounds nothing: the families hold one problem in other units.
TEST(Families, ScalingIsExact) {
  const Problem one = make_scenes("UNIT").at(0).problem;
  for (const char* text : {"UNIT(k=-20)", "UNIT(k=20)"}) {
    const Problem p = make_scenes(text).at(0).problem;
    const double s = p.c[0] / one.c[0];
    Vector unit(p.size());
    for (Index j = 0; j < p.size(); ++j) unit[j] = j % 6 < 3 ? s : 1;
    EXPECT_EQ(p.c, one.c * s);
    EXPECT_EQ(p.z_u, one.z_u.cwiseProduct(unit));
    EXPECT_EQ(Matrix(p.J) * unit.asDiagonal(), Matrix(one.J) * s);
    EXPECT_EQ(Matrix(p.M), Matrix(one.M) * unit.cwiseInverse().cwiseAbs2().asDiagonal() * s * s);
  }
  for (const char* text : {"ROW(k=-500)", "ROW(k=500)"}) {
    const Problem p = make_scenes(text).at(0).problem;
    int scaled = 0;
    for (Index i = 0; i < p.rows(); ++i) {
      const double s = Matrix(p.J).row(i).lpNorm<Eigen::Infinity>() / Matrix(one.J).row(i).lpNorm<Eigen::Infinity>();
      EXPECT_EQ(Matrix(p.J).row(i), Matrix(one.J).row(i) * s);
      EXPECT_EQ(p.c[i], one.c[i] * s);
      scaled += s != 1;
    }
    EXPECT_EQ(scaled, 3);
  }
}

// Murty (1988): exchanging every row of the wrong sign, from the empty set, comes back to a set it has been at.
TEST(Families, CycleSeedsMakeBlockPivotingCycle) {
  for (const Instance& in : make_scenes("CYCLE(n=5..8)")) {
    const Matrix J = in.problem.J, S = J * J.transpose();
    ASSERT_GT(std::abs(J.determinant()), .5) << "so that there is one answer";
    std::set<std::vector<Index>> seen;
    std::vector<Index> pushing;
    while (seen.insert(pushing).second) {
      Vector lambda = Vector::Zero(J.rows());
      lambda(pushing) = S(pushing, pushing).ldlt().solve(Vector(in.problem.c(pushing))).eval();
      const Vector slack = S * lambda - in.problem.c;
      std::vector<Index> next;
      for (Index i = 0; i < J.rows(); ++i) {
        const bool pushes = std::ranges::find(pushing, i) != pushing.end();
        if (pushes ? lambda[i] >= -1e-9 : slack[i] < -1e-9) next.push_back(i);
      }
      ASSERT_NE(next, pushing) << "it ends: " << in.problem.name;
      pushing = next;
    }
  }
}

TEST(Families, FilmKeepsItsKeys) {
  const std::vector<Instance> film = make_scenes("FLIP(k=48,frame=0..9)");
  for (std::size_t f = 1; f < film.size(); ++f) {
    std::vector<RowKey> before = film[f - 1].problem.key, now = film[f].problem.key, both;
    std::ranges::set_intersection(before, now, std::back_inserter(both));
    EXPECT_NE(before, now);
    EXPECT_GE(2 * both.size(), now.size()) << "most stay";
    EXPECT_EQ(film[f].problem.c, Vector::Constant(film[f].problem.rows(), 0x1p-48));
  }
}

TEST(RandomRows, AnswersAreExact) {
  for (const Instance& in : make_scenes("random(seed=1..20)")) {
    expect_true_answer(in);
    EXPECT_EQ(in.reference->bound, 0) << "small integers and powers of two round nothing";
    EXPECT_GT(in.reference->z.norm(), 1);
    EXPECT_EQ(in.reference->method, "known answer");
  }
}

TEST(RandomRows, KnobsDoWhatTheySay) {
  const Instance in = make_scenes("random(n=200,m=300,equalities=0.2,active=1,condition=20,redundancy=0.5)").at(0);
  expect_true_answer(in);
  EXPECT_EQ(in.problem.size(), 200);
  EXPECT_EQ(in.problem.rows(), 300);
  EXPECT_EQ(std::ranges::count(in.problem.kind, RowKind::equality), 60);
  EXPECT_GE((in.reference->lambda.array() != 0).count(), 299);
  const Vector mass = Matrix(in.problem.M).diagonal();
  EXPECT_GE(mass.maxCoeff() / mass.minCoeff(), std::exp2(19));
  const auto is_sum = [](const RowOrigin& origin) { return origin.label.ends_with("(a sum)"); };
  EXPECT_GT(std::ranges::count_if(in.origin, is_sum), 100);
  EXPECT_LT(std::ranges::count_if(in.origin, is_sum), 200);
  EXPECT_EQ(make_scenes("random(m=0)").at(0).problem.rows(), 0);
  EXPECT_EQ(make_scenes("random(n=1,m=3)").at(0).problem.size(), 1);
}

TEST(RandomRows, SameSeedSameBitsOtherSeedOtherProblem) {
  const auto name = [](const char* text) { return problem_sha256(make_scenes(text).at(0).problem); };
  EXPECT_EQ(name("random(seed=7)"), name("random(seed=7)"));
  EXPECT_NE(name("random(seed=7)"), name("random(seed=8)"));
  EXPECT_EQ(name("random(seed=7)"), "57d86ce38a692a42ba3e30ea699f5910f4f3baeb0436f1e748424c03357c470b")
      << "every compiler draws the same problem";
  EXPECT_NE(name("NPE(seed=7)"), name("NPE(seed=8)"));
}

// Rows of full mantissas: the structure of a tower of boxes with sizes that round.
TEST(KnownAnswer, FitsTheStructureOfAnyProblem) {
  for (Instance in : make_scenes("tower(boxes=3,30)")) {
    const Problem before = in.problem;
    for (const std::uint64_t seed : {1, 2, 3}) {
      in = with_known_answer(std::move(in), seed, 0.3);
      expect_true_answer(in);
      EXPECT_EQ(Matrix(in.problem.J), Matrix(before.J));
      EXPECT_EQ(Matrix(in.problem.M), Matrix(before.M));
      EXPECT_LE(in.reference->bound, 1e-15);
      EXPECT_GT(in.reference->z.norm(), 1);
      const auto pushing = (in.reference->lambda.array() > 0).count();
      EXPECT_GT(pushing, before.rows() / 8);
      EXPECT_LT(pushing, before.rows() / 2);
    }
  }
}

TEST(KnownAnswer, KeepsInactiveRowsAndRefusesAnIndefiniteMass) {
  Instance in = make_scenes("GAP").at(0);
  in.problem.c[1] = -std::numeric_limits<double>::infinity();
  in = with_known_answer(std::move(in), 1, 1);
  EXPECT_EQ(in.problem.c[1], -std::numeric_limits<double>::infinity());
  EXPECT_EQ(in.reference->lambda[1], 0);
  in.problem.M.coeffRef(0, 0) = -1;
  EXPECT_THROW(with_known_answer(std::move(in), 1, 1), std::invalid_argument);
}

}  // namespace
}  // namespace zwang
