#include <zwang/core/referee/sparse_proof.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "tests/core/referee/hundred_digits.h"
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

using test::make_problem;
using test::vec;

Proof prove(const Problem& p, const Vector& z, const Vector& lambda) {
  const ScaledProblem scaled(p);
  return prove_sparse(scaled, scaled.motion(z), scaled.multipliers(lambda));
}

bool gives_nothing(const Proof& proof) {
  return proof.rows == DistanceBound::Rows::open && proof.radius == std::numeric_limits<double>::infinity();
}

// The bound of large stacks, on small problems of inequality rows.
TEST(SparseProof, HoldsAgainstEnumerationIn100Digits) {
  std::mt19937_64 random(2);
  int proven = 0, useful = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    Problem p = random_problem(random, trial % 4);
    std::ranges::fill(p.kind, RowKind::inequality);
    const std::optional<Answer> truth = brute_force(p);
    const ScaledProblem scaled(p);
    for (const double error : {0.0, 1e-15, 1e-9, 1e-3}) {
      Vector z = truth ? rounded(truth->z) : p.z_u, lambda = Vector::Zero(p.rows());
      if (truth) lambda = rounded(truth->lambda);
      for (double& x : z) x += error * std::normal_distribution<>()(random);
      for (double& x : lambda) x *= 1 + error * std::normal_distribution<>()(random);
      const Proof proof = prove_sparse(scaled, scaled.motion(z), scaled.multipliers(lambda));
      if (proof.radius == std::numeric_limits<double>::infinity()) continue;
      ASSERT_TRUE(truth) << "trial " << trial << ": infeasible problem";
      BigVector off;
      for (Index i = 0; i < proof.d.size(); ++i) {
        const Big d = exactly(proof.d[i].hi) + exactly(proof.d[i].lo),
                  unit = exactly(std::ldexp(1.0, scaled.motion_exponent));
        off.push_back(exactly(p.z_u[i]) + d * unit - truth->z[at(i)]);
      }
      const Big distance = big_norm(Matrix(p.M), off);
      ASSERT_LE(distance, exactly(scaled.to_problem_norm(proof.radius)) + Big("1e-60"))
          << "trial " << trial << " error " << error;
      ++proven;
      useful += scaled.to_problem_norm(proof.radius) <= 1e-12;
    }
  }
  EXPECT_GT(proven, 4000);
  EXPECT_GE(useful, 0.7 * proven) << useful << " of " << proven;
  std::cout << "bounded: " << proven << ", to 1e-12: " << useful << '\n';
}

// A stack of 3000 masses, more than the dense proof takes: its rows all push, and moving up opens them all.
TEST(SparseProof, BoundsALargeStackFromARoughGuess) {
  constexpr Index n = 3000;
  const Problem p = test::tower(n);
  Vector lambda(n);
  for (Index i = 0; i < n; ++i) lambda[i] = 9.8125 * static_cast<double>(n - i) * (i % 2 ? 1.001 : 1);
  const Proof proof = prove(p, Vector::Constant(n, 1e-12), lambda);
  EXPECT_EQ(proof.rows, DistanceBound::Rows::feasible);
  const ScaledProblem scaled(p);
  const double length = scaled.norm_of_free_motion();
  EXPECT_LE(proof.radius, 1e-12 * length);
  EXPECT_LE(scaled.norm_with_free_motion(proof.d), proof.radius * (1 + 1e-9)) << "z = 0 lies in the ball";
}

TEST(SparseProof, SaysNothingWhereItsArgumentDoesNotReach) {
  const Vector one = vec({1});
  EXPECT_TRUE(gives_nothing(prove(test::tied_pair(), vec({0, 0}), vec({-40, 50})))) << "equality rows";
  EXPECT_TRUE(gives_nothing(prove(test::squeezed(), vec({0}), vec({0, 0})))) << "infeasible";
  EXPECT_TRUE(gives_nothing(prove(test::zero_row_conflict(), vec({0}), vec({0})))) << "a row of zeros that cannot hold";
  const Problem wedged = make_problem(one, vec({-1}), {{RowKind::inequality, one, 0}, {RowKind::inequality, -one, 0}});
  EXPECT_TRUE(gives_nothing(prove(wedged, vec({0}), vec({1, 0})))) << "no motion opens both rows";
  EXPECT_TRUE(gives_nothing(prove(test::tower(3), vec({-5, -5, -5}), Vector::Zero(3)))) << "a guess without pushes";
}

}  // namespace
}  // namespace zwang
