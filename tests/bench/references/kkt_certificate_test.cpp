#include <gtest/gtest.h>

#include <boost/multiprecision/mpfr.hpp>
// after the number type it describes
#include <boost/multiprecision/eigen.hpp>
#include <random>

#include <zwang/bench/references/kkt_certificate.h>
#include "tests/core/referee/hundred_digits.h"
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

using test::make_problem;
using test::vec;
using Certificate = KktCertificate<Big>;
using Numbers = VectorX<Big>;

Numbers numbers(const BigVector& x) { return Eigen::Map<const Numbers>(x.data(), static_cast<Index>(x.size())); }
Numbers numbers(const Vector& x) { return x.cast<Big>(); }

Big norm(const Problem& p, const Numbers& d) { return big_norm(Matrix(p.M), BigVector(d.begin(), d.end())); }

// Answers by enumeration in 100 digits, on problems full of degenerate, redundant and weakly active rows: all accepted.
// The same answer moved by 1e-30 of its size, along one unknown or along all, is refused, and so is one whose
// multiplier has the wrong sign.
TEST(KktCertificate, AcceptsTheTruthAndRefusesWhatIsOffInTheThirtiethDigit) {
  std::mt19937_64 random(11);
  int moved = 0, turned = 0;
  for (int k = 0; k < 1200; ++k) {
    const Problem p = random_problem(random, k % 4);
    const auto answer = brute_force(p);
    if (!answer) continue;
    const Certificate certificate(p);
    const Numbers z = numbers(answer->z), lambda = numbers(answer->lambda);
    ASSERT_EQ(certificate.refuse(z, lambda), "") << k;

    const Big scale = std::max(norm(p, numbers(p.z_u)), norm(p, z));
    if (scale > 0) {
      Numbers one = Numbers::Unit(p.size(), static_cast<Index>(random() % static_cast<unsigned>(p.size())));
      Numbers all(p.size());
      for (Big& a : all) a = std::normal_distribution<>()(random);
      for (const Numbers& d : {one, all}) {
        EXPECT_NE(certificate.refuse(Numbers(z + d * Big("1e-30") * scale / norm(p, d)), lambda), "") << k;
        ++moved;
      }
    }
    for (Index i = 0; i < p.rows(); ++i) {
      if (p.is_equality(i) || !(lambda[i] > Big("1e-60"))) continue;
      Numbers wrong = lambda;
      wrong[i] = -wrong[i];
      EXPECT_NE(certificate.refuse(z, wrong), "") << k;
      ++turned;
    }
  }
  EXPECT_GT(moved, 1000);
  EXPECT_GT(turned, 300);
}

// A row that is there twice: 5 and -3 balance the forces as 2 and 0 do, but a contact does not pull.
TEST(KktCertificate, RefusesAPullThatAnotherRowMakesUpFor) {
  const Problem p =
      make_problem(vec({1}), vec({-2}), {{RowKind::inequality, vec({1}), 0}, {RowKind::inequality, vec({1}), 0}});
  const Certificate certificate(p);
  const Numbers z = Numbers::Zero(1);
  EXPECT_EQ(certificate.refuse(z, numbers(vec({2, 0}))), "");
  EXPECT_EQ(certificate.refuse(z, numbers(vec({.5, 1.5}))), "");
  EXPECT_NE(certificate.refuse(z, numbers(vec({5, -3}))), "");
}

TEST(KktCertificate, RefusesAPushOfARowThatDoesNotTouch) {
  const Problem p =
      make_problem(vec({1}), vec({-2}), {{RowKind::inequality, vec({1}), -1}, {RowKind::inequality, vec({1}), -3}});
  const Certificate certificate(p);
  EXPECT_EQ(certificate.refuse(numbers(vec({-1})), numbers(vec({1, 0}))), "");
  EXPECT_NE(certificate.refuse(numbers(vec({-1})), numbers(vec({0, 1}))), "");
  EXPECT_NE(certificate.refuse(numbers(vec({-1})), numbers(vec({1}))), "") << "one multiplier for two rows";
  EXPECT_NE(certificate.refuse(numbers(vec({-1.5})), numbers(vec({.5, 0}))), "") << "the row is violated";
}

TEST(KktCertificate, RefusesAPointWhoseJointsContradictEachOtherBelowTheDigitsOfDoubles) {
  const double tiny = std::ldexp(1.0, -1000);
  const auto joints = [&](double c) {
    return make_problem(vec({1}), vec({0}), {{RowKind::equality, vec({1}), 0}, {RowKind::equality, vec({2}), c}});
  };
  const Numbers zero = Numbers::Zero(1), none = Numbers::Zero(2);
  EXPECT_EQ(Certificate(joints(0)).refuse(zero, none), "");
  EXPECT_NE(Certificate(joints(tiny)).refuse(zero, none), "");
  EXPECT_NE(Certificate(joints(tiny)).refuse(Numbers::Constant(1, Big(tiny / 2)), none), "");
}

TEST(KktCertificate, RefusesAnIndefiniteMass) {
  Problem p = test::tied_pair();
  p.M.coeffRef(0, 0) = -1;
  EXPECT_NE(Certificate(p).refuse(Numbers::Zero(2), Numbers::Zero(2)), "");
}

TEST(KktCertificate, DecidesProofsOfInfeasibility) {
  // x >= 1, -x >= 0
  const Problem p =
      make_problem(vec({1}), vec({3}), {{RowKind::inequality, vec({1}), 1}, {RowKind::inequality, vec({-1}), 0}});
  const Certificate certificate(p);
  EXPECT_EQ(certificate.refuse_infeasible(numbers(vec({2, 2}))), "");
  EXPECT_NE(certificate.refuse_infeasible(numbers(vec({1, 0}))), "");
  EXPECT_NE(certificate.refuse_infeasible(numbers(vec({-1, -1}))), "") << "contacts do not pull";
  EXPECT_NE(certificate.refuse_infeasible(numbers(vec({0, 0}))), "");
  EXPECT_NE(certificate.refuse_infeasible(numbers(vec({1}))), "");
  Numbers off = numbers(vec({1, 1}));
  off[0] += Big("1e-30");
  EXPECT_NE(certificate.refuse_infeasible(off), "");
  Problem open = p;
  open.c[0] = -1;
  EXPECT_NE(Certificate(open).refuse_infeasible(numbers(vec({1, 1}))), "") << "x = 0 meets both";
}

}  // namespace
}  // namespace zwang
