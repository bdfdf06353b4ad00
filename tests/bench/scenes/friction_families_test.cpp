#include <gtest/gtest.h>

#include <boost/multiprecision/gmp.hpp>

#include <zwang/bench/references/friction/exact_solutions.h>
#include <zwang/bench/scenes/friction/families.h>
#include <zwang/core/referee/measure.h>

namespace zwang {
namespace {

using Rational = boost::multiprecision::mpq_rational;
using RationalVector = std::vector<Rational>;

// "" where (z, lambda) solves the problem exactly, under Coulomb's law.
std::string exact_fault(const Problem& p, const Vector& z, const Vector& lambda) {
  const auto n = static_cast<std::size_t>(p.size());
  RationalVector force(n, 0);
  for (Index j = 0; j < p.size(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(p.M, j); it; ++it)
      force[static_cast<std::size_t>(it.row())] += Rational(it.value()) * (Rational(z[j]) - Rational(p.z_u[j]));
  RationalVector slack;
  for (Index i = 0; i < p.rows(); ++i) {
    slack.push_back(-Rational(p.c[i]));
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, i); it; ++it) {
      slack.back() += Rational(it.value()) * Rational(z[it.col()]);
      force[static_cast<std::size_t>(it.col())] -= Rational(it.value()) * Rational(lambda[i]);
    }
  }
  for (const Rational& f : force)
    if (f != 0) return "forces do not balance";
  for (Index i = 0; i < p.rows(); ++i) {
    const Rational s = slack[static_cast<std::size_t>(i)], l = lambda[i], mu = p.mu[i];
    if (s < 0 || l < 0 || s * l != 0) return "normal";
    Rational friction = 0, slip = 0, work = 0;
    const Index tangents = p.tangents(i);
    for (Index t = 1; t <= tangents; ++t) {
      const Rational l_t = lambda[i + t], s_t = slack[static_cast<std::size_t>(i + t)];
      friction += l_t * l_t;
      slip += s_t * s_t;
      work += l_t * s_t;
    }
    if (friction > mu * mu * l * l) return "cone";
    // mu l |s_t| + l_t's_t = 0, squared: work <= 0 and work^2 = mu^2 l^2 slip.
    if (work > 0 || work * work != mu * mu * l * l * slip) return "dissipation";
    i += tangents;
  }
  return {};
}

TEST(FrictionFamilies, PlantedAnswersAreExactInRationals) {
  int checked = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed)
    for (const double mu : {0x1p-6, .125, .5, 2.}) {
      PlantedFriction o{.contacts = 5 + static_cast<Index>(seed % 4) * 5, .mu = mu, .seed = seed};
      o.tangents = seed % 3 == 0 ? 1 : 2;
      if (seed % 5 == 0) o.load_exponent = -10;
      if (seed % 7 == 0) o.slip_exponent = -10;
      const Instance planted = planted_friction(o);
      ASSERT_TRUE(planted.reference) << seed << " mu " << mu;
      ASSERT_EQ(bad_input(planted.problem), "");
      EXPECT_EQ(exact_fault(planted.problem, planted.reference->z, planted.reference->lambda), "") << seed;
      ++checked;
    }
  EXPECT_GE(checked, 1000);
}

// The referee never calls a planted answer wrong, and an answer that is off never solved.
TEST(FrictionFamilies, TheRefereeTellsNoLieOnPlantedAnswers) {
  int solved = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 250; ++seed)
    for (const double mu : {0x1p-6, .125, .5, 2.}) {
      const Instance planted = planted_friction({.contacts = 5, .mu = mu, .seed = seed});
      Solution s;
      s.status = Status::solved;
      s.z = planted.reference->z;
      s.lambda = planted.reference->lambda;
      const Metrics m = measure(planted.problem, s, nullptr, 1e-13);
      EXPECT_NE(m.verdict, Verdict::wrong) << seed << " mu " << mu;
      EXPECT_LE(m.friction.natural, 1e-15);
      solved += m.verdict == Verdict::solved;
      if (m.verdict == Verdict::solved) {
        EXPECT_LE(m.z_bound, 1e-12);
      }
      s.z[0] += 1e-3 * s.z.norm();
      EXPECT_NE(measure(planted.problem, s, nullptr, 1e-13).verdict, Verdict::solved) << seed << " mu " << mu;
      ++all;
    }
  EXPECT_EQ(all, 1000);
  EXPECT_GE(solved, 990);
}

TEST(FrictionFamilies, NumbersOfSolutionsAreConfirmedInRationals) {
  const auto count = [](const FrictionPoint& point) {
    const std::optional<ExactSolutions> all = enumerate_planar(point.instance.problem);
    return !all ? -2 : !all->complete() ? -1 : static_cast<int>(all->solutions().size());
  };
  for (const FrictionPoint& point : {rod_point(1), rod_point(1.5), rod_point(2), jam_point(.5, -1), jam_point(.75, -1),
                                     jam_point(1, -1), jam_point(1, 1), held_point(.5), held_point(1), pinch_point()})
    EXPECT_EQ(count(point), point.solutions) << point.instance.family << " mu " << point.instance.problem.mu[0];
}

TEST(FrictionFamilies, PuckIsSolvedAndNotIsolated) {
  const FrictionPoint puck = puck_point();
  ASSERT_TRUE(puck.instance.reference);
  Solution s;
  s.status = Status::solved;
  s.z = puck.instance.reference->z;
  s.lambda = puck.instance.reference->lambda;
  EXPECT_EQ(exact_fault(puck.instance.problem, s.z, s.lambda), "");
  const Metrics m = measure(puck.instance.problem, s, nullptr, 1e-13);
  EXPECT_EQ(m.verdict, Verdict::solved);
  EXPECT_FALSE(m.friction.isolated);
  EXPECT_GT(m.friction.null_motion, 1e-4);
}

TEST(FrictionFamilies, EveryKnobMakesAProblem) {
  for (const auto& family : friction_families()) {
    ASSERT_TRUE(find_scene(family.first)) << family.first;
    const SceneEntry& entry = *find_scene(family.first);
    for (const bool low : {true, false}) {
      Knobs knobs;
      for (const Knob& knob : entry.knobs) knobs[knob.name] = knob.value;
      if (!entry.knobs.empty()) {
        const Knob& swept = entry.knobs[0];
        knobs[swept.name] = low ? swept.low : std::min(swept.high, swept.name == "k" ? swept.high : 8);
      }
      const Instance made = entry.make(knobs);
      EXPECT_EQ(bad_input(made.problem), "") << entry.name;
      EXPECT_TRUE(made.problem.has_tangents()) << entry.name;
      EXPECT_EQ(made.problem.law, Law::coulomb);
      EXPECT_EQ(static_cast<Index>(made.origin.size()), made.problem.rows());
    }
  }
}

}  // namespace
}  // namespace zwang
