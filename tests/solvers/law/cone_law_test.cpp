// The object that a law is to solvers, without any solver: by brute force, by differences, and at planted answers.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <zwang/core/referee/friction/law.h>
#include <zwang/solvers/law/cone_law.h>
#include <zwang/solvers/linalg/lanes.h>

namespace zwang {
namespace {

constexpr std::array lifts_of_laws{0.0, 0.5, 1.0};  // convex, a law between, Coulomb's

class ConeLaws : public testing::TestWithParam<double> {
 protected:
  const ConeLaw law{.lift = GetParam()};
  std::mt19937_64 random{7};
  double draw() { return std::uniform_real_distribution<double>(-1, 1)(random); }
  Vec3 any() { return {draw(), draw(), draw()}; }
};

// The point of {|x_t| <= mu x_0} nearest to x: of each ray (1, q mu (cos a, sin a)), among ever finer grids of rays.
Vec3 nearest_by_search(const Vec3& x, double mu) {
  constexpr int grid = 16;
  Vec3 best = Vec3::Zero();
  double share = 0.5, angle = 0;
  for (double room = 1; room > 1e-12; room *= 0.7) {
    const double q0 = share, a0 = angle;
    for (int i = -grid; i <= grid; ++i)
      for (int k = -grid; k <= grid; ++k) {
        const double q = std::clamp(q0 + room * i / grid, 0.0, 1.0), a = a0 + room * std::numbers::pi * k / grid;
        const Vec3 ray(1, q * mu * std::cos(a), q * mu * std::sin(a));
        const Vec3 point = std::max(0.0, x.dot(ray) / ray.squaredNorm()) * ray;
        if ((point - x).squaredNorm() < (best - x).squaredNorm()) best = point, share = q, angle = a;
      }
  }
  return best;
}

TEST_P(ConeLaws, TheResidualIsThatOfTheNearestPointOfTheCone) {
  for (int trial = 0; trial < 40; ++trial) {
    const double mu = std::exp2(draw());
    const Vec3 y = any(), s = any(), l(y[0] / mu, y[1], y[2]);
    const Vec3 shifted(mu * (s[0] + law.lift * std::hypot(s[1], s[2])), s[1], s[2]);
    const double violated = std::max(0.0, mu * std::hypot(s[1], s[2]) - shifted[0]);
    const double off = (l - nearest_by_search(l - shifted, mu)).lpNorm<Eigen::Infinity>();
    EXPECT_NEAR(law.residual(y.data(), s.data(), mu).natural, std::max(off, violated), 1e-6) << trial;
    const Vec3 onto = second_order_cone::projected(y);
    EXPECT_LE((onto - nearest_by_search(y, 1)).norm(), 1e-6) << trial;
    EXPECT_GE(second_order_cone::smallest(onto.data()), -1e-15);
  }
}

struct Contact {
  ConeLaw::Mode mode;
  Vec3 y, s;
  double mu;
};

// In numbers that doubles hold, 3-4-5, so that nothing is rounded.
std::vector<Contact> planted(const ConeLaw& law) {
  using enum ConeLaw::Mode;
  std::vector<Contact> all;
  for (const double mu : {0.25, 1.0, 2.0})
    for (const double push : {0.5, 8.0}) {
      const double slip = 3 * mu * push;
      all.push_back({slide, mu * push * Vec3(5, -3, -4), slip * Vec3(5 * law.opening(), 3, 4), mu});
      all.push_back({stick, mu * push * Vec3(5, 2, -1), Vec3::Zero(), mu});
      all.push_back({open, Vec3::Zero(), slip * Vec3(6, 3, -4), mu});
    }
  return all;
}

TEST_P(ConeLaws, TheResidualIsZeroAtPlantedAnswersAndNowhereBeside) {
  for (const Contact& c : planted(law)) {
    const ConeLaw::Residual at = law.residual(c.y.data(), c.s.data(), c.mu);
    EXPECT_EQ(at.natural, 0);
    EXPECT_EQ(at.gap, 0);
    ConeLaw::Slide slide;
    EXPECT_EQ(law.mode(c.y.data(), c.s.data(), slide), c.mode);
    for (int i = 0; i < 6; ++i) {
      Contact off = c;
      (i < 3 ? off.y : off.s)[i % 3] -= 0.125;
      if (c.mode == ConeLaw::Mode::open && i >= 3) continue;  // open is open
      if (c.mode == ConeLaw::Mode::stick && i < 3) continue;  // what sticks may carry more or less
      EXPECT_GT(law.residual(off.y.data(), off.s.data(), c.mu).natural, 1e-3) << i;
    }
  }
}

// What a contact answers to p = y - s: 0, p, or a (1, u).
Vec3 answer(const ConeLaw& law, const Vec3& p) {
  const double size = std::hypot(p[1], p[2]), pressure = (p[0] + (1 - law.lift) * size) / (2 - law.lift);
  if (pressure <= 0) return Vec3::Zero();
  return size <= p[0] ? p : Vec3(pressure, pressure * p[1] / size, pressure * p[2] / size);
}

TEST_P(ConeLaws, TheBlockIsTheDerivativeOfTheAnswer) {
  constexpr double step = 1e-6;
  int met[3] = {0, 0, 0};
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 y = any(), s = any(), p = y - s;
    ConeLaw::Slide slide;
    const ConeLaw::Mode mode = law.mode(y.data(), s.data(), slide);
    const double size = std::hypot(p[1], p[2]);
    if (std::abs(p[0] - size) < 1e-3 || std::abs(p[0] + law.opening() * size) < 1e-3) continue;  // a kink
    ++met[static_cast<int>(mode)];
    Mat3 D = Mat3::Zero();
    Vec3 next = Vec3::Zero();
    law.linearize(mode, slide, 1, 1, 1, y.data(), s.data(), D.data(), next.data());
    for (int i = 0; i < 3; ++i) {
      const Vec3 way = step * Vec3::Unit(i);
      const Vec3 slope = (answer(law, p + way) - answer(law, p - way)) / (2 * step);
      EXPECT_LE((D.col(i) - slope).norm(), 1e-7) << trial << " " << i;
    }
  }
  for (const int count : met) EXPECT_GE(count, 20);
}

// One contact of a known answer, with any Delassus block: a few steps of Newton's method end there, stiff or soft.
TEST_P(ConeLaws, NewtonsMethodEndsAtTheAnswer) {
  for (const Contact& c : planted(law)) {
    const Mat3 A = Mat3::Identity() + 0.2 * Mat3::Random(), W = A * A.transpose();
    const Vec3 b = c.s - W * c.y;
    for (const double softness : {1.0, 1e-6}) {
      Vec3 y = c.y + 0.01 * any(), s = W * y + b;
      for (int step = 0; step < 60; ++step) {
        ConeLaw::Slide slide;
        Mat3 D = Mat3::Zero();
        Vec3 next = Vec3::Zero();
        law.linearize(law.mode(y.data(), s.data(), slide), slide, softness, softness, 1, y.data(), s.data(), D.data(),
                      next.data());
        y = Eigen::FullPivLU<Mat3>(Mat3::Identity() + D * W).solve(next - D * (b - s));
        s = W * y + b;
      }
      EXPECT_LE((y - c.y).norm() + (s - c.s).norm(), 1e-9 * (c.y.norm() + c.s.norm())) << softness;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, ConeLaws, testing::ValuesIn(lifts_of_laws),
                         [](const auto& i) { return "lift_" + std::to_string(static_cast<int>(100 * i.param)); });

// The referee's law is its own; the two say the same of each.
TEST(LawEntries, SolversAndRefereeReadTheSameLaws) {
  for (const Law law : all_laws) {
    EXPECT_EQ(lifts(law), referee::slip_lifts(law)) << to_string(law);
    EXPECT_EQ(ConeLaw::of(law).lift, lift_of(law));
    EXPECT_EQ(parse_law(to_string(law)), law);
    EXPECT_EQ(has_cones(without_lift(law)), has_cones(law));
  }
  EXPECT_EQ(laws_that<has_cones>, (std::array{Law::convex, Law::coulomb}));
  EXPECT_EQ(laws_that<lifts>, std::array{Law::coulomb});
}

// Cones one a lane give what one cone after the other gives, to the bit, and come back to where they stood.
TEST(SecondOrderCone, OfSeveralConesAtOnceIsThatOfEach) {
  namespace soc = second_order_cone;
  using Pack = lanes::PackOf<1>;
  constexpr std::size_t few = Pack::lanes, numbers = 3 * few;
  std::srand(1);
  for (int round = 0; round < 200; ++round) {
    std::array<std::array<double, numbers>, 3> at;  // y, w inside; d anywhere
    for (auto& x : at)
      for (double& own : x) own = Vec<double, 1>::Random()[0];
    for (std::size_t i = 0; i < numbers; i += 3)
      for (std::size_t x : {0, 1}) at[x][i] = soc::tangential(&at[x][i]) + std::abs(at[x][i]) + 1e-3;
    const soc::Three<Pack> y = lanes::Threes::load(at[0].data()).x, w = lanes::Threes::load(at[1].data()).x,
                           d = lanes::Threes::load(at[2].data()).x;
    std::array<double, numbers> back;
    lanes::Threes{d}.store(back.data());
    EXPECT_EQ(back, at[2]);
    const auto scaling = soc::Scaling<Pack>::of(y.data(), w.data());
    const soc::Three<Pack> product = soc::product(scaling.times(d.data()), scaling.inverse_times(d.data())),
                           quotient = soc::quotient(y, product), weighed = soc::multiply(scaling.weight(), product);
    for (std::size_t k = 0; k < few; ++k) {
      const double *Y = &at[0][3 * k], *W = &at[1][3 * k], *D = &at[2][3 * k];
      const auto own = soc::Scaling<double>::of(Y, W);
      const soc::Three<double> p = soc::product(own.times(D), own.inverse_times(D)),
                               q = soc::quotient<double>({Y[0], Y[1], Y[2]}, p), r = soc::multiply(own.weight(), p);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(p[i], product[i].data()[k]);
        EXPECT_EQ(q[i], quotient[i].data()[k]);
        EXPECT_EQ(r[i], weighed[i].data()[k]);
      }
      // W y = W^-1 w.
      const soc::Three<double> one = own.times(Y), other = own.inverse_times(W);
      for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(one[i], other[i], 1e-9);
    }
  }
}

}  // namespace
}  // namespace zwang
