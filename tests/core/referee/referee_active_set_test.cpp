#include <zwang/core/referee/referee_active_set.h>

#include <gtest/gtest.h>

#include <random>

#include <zwang/core/referee/certificate.h>
#include "tests/core/referee/hundred_digits.h"
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

using Outcome = RefereeActiveSet::Outcome;

ExtendedVector zeros(Index size) { return ExtendedVector::Zero(size); }

bool has_impossible_zero_row(const ScaledProblem& scaled) {
  for (Index i = 0; i < scaled.rows(); ++i)
    if (scaled.is_zero(i) && !scaled.is_vacuous(i) && !scaled.zero_row_holds(i)) return true;
  return false;
}

double distance(const Problem& p, const ScaledProblem& scaled, const ExtendedVector& d, const BigVector& z) {
  BigVector off;
  for (Index i = 0; i < d.size(); ++i)
    off.push_back(exactly(p.z_u[i]) +
                  (exactly(d[i].hi) + exactly(d[i].lo)) * exactly(std::ldexp(1.0, scaled.motion_exponent)) - z[at(i)]);
  return static_cast<double>(big_norm(Matrix(p.M), off));
}

// From no guess, from a right one and from a wrong one: the same z to far more digits than a double has, multipliers
// that are not negative, and a proof where there is no z. Nothing of it is believed without a proof, so it may fail now
// and then where rows are nearly parallel to 2^-45; but no proof may say more than is true.
TEST(RefereeActiveSet, AgreesWithEnumerationIn100DigitsFromAnyGuess) {
  std::mt19937_64 random(5);
  int solved = 0, infeasible = 0, doubtful = 0, gave_up = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Problem p = random_problem(random, trial % 4);
    const std::optional<Answer> truth = brute_force(p);
    const ScaledProblem scaled(p);
    if (has_impossible_zero_row(scaled)) continue;
    Vector wrong = Vector::Zero(p.rows());
    for (double& x : wrong) x = std::normal_distribution<>()(random);
    std::vector<Vector> guesses{Vector::Zero(p.rows()), wrong};
    if (truth) guesses.push_back(rounded(truth->lambda));
    for (const Vector& guess : guesses) {
      RefereeActiveSet method(scaled);
      const ExtendedVector lambda = scaled.multipliers(guess);
      const Outcome outcome = method.solve(zeros(p.size()), &lambda);
      if (outcome == Outcome::gave_up) {
        ++gave_up;
        continue;
      }
      if (outcome == Outcome::infeasible) {
        const double s = std::max(scaled.norm_of_free_motion(), scaled.least_scale());
        const Farkas farkas = judge_certificate(scaled, method.farkas, s);
        infeasible += !truth && farkas.proven;
        doubtful += truth || !farkas.proven;
        if (truth) {
          EXPECT_GE(distance(p, scaled, zeros(p.size()), truth->z), scaled.to_problem_norm(farkas.distance)) << trial;
        }
        continue;
      }
      ASSERT_TRUE(truth) << trial;
      ++solved;
      // Nearly parallel rows put z at 1e12; where long double is x87's, such trials are given up.
      const double size = static_cast<double>(big_norm(Matrix(p.M), truth->z));
      EXPECT_LE(distance(p, scaled, method.d, truth->z), 1e-17 * std::max(1.0, size)) << trial;
      for (const Index i : method.basis) doubtful += !p.is_equality(i) && method.lambda[i].hi < -1e-20;
      EXPECT_EQ(static_cast<Index>(method.basis.size()), method.rows.rank()) << trial;
    }
  }
  EXPECT_GT(solved, 2000);
  EXPECT_GT(infeasible, 300);
  EXPECT_LE(gave_up, 0.01 * solved);
  EXPECT_LE(doubtful, 0.01 * solved);
  std::cout << "solved " << solved << ", infeasible " << infeasible << ", doubtful " << doubtful << ", gave up "
            << gave_up << '\n';
}

TEST(RefereeActiveSet, GuessesRowsThatAreTouchedWhereThereAreNoMultipliers) {
  const Problem p = test::tower(5);
  const ScaledProblem scaled(p);
  RefereeActiveSet method(scaled);
  ASSERT_EQ(method.solve(scaled.motion(Vector::Constant(5, 1e-9)), nullptr), Outcome::optimal);
  EXPECT_EQ(method.basis.size(), 5u);
  EXPECT_LE(distance(p, scaled, method.d, BigVector(5, Big(0))), 1e-25);
}

TEST(RefereeActiveSet, LeavesOutEqualityRowsThatDependOnOthers) {
  const Problem p = test::make_problem(test::vec({1, 1}), test::vec({0, -3}),
                                       {{RowKind::equality, test::vec({1, 0}), 2},
                                        {RowKind::equality, test::vec({2, 0}), 4},
                                        {RowKind::inequality, test::vec({0, 1}), 0}});
  const ScaledProblem scaled(p);
  RefereeActiveSet method(scaled);
  ASSERT_EQ(method.solve(zeros(2), nullptr), Outcome::optimal);
  EXPECT_EQ(method.equality_rank, 1);
  EXPECT_LE(distance(p, scaled, method.d, {Big(2), Big(0)}), 1e-25);
}

TEST(RefereeActiveSet, GivesUpAtItsWorkLimit) {
  const ScaledProblem scaled(test::tower(50));
  RefereeActiveSet method(scaled, 1000);
  EXPECT_EQ(method.solve(zeros(50), nullptr), Outcome::gave_up);
}

}  // namespace
}  // namespace zwang
