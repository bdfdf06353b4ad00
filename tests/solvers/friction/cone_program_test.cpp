// A problem as a cone program: rows against J, and the way to it and back.
#include <zwang/solvers/friction/cone_program.h>

#include <gtest/gtest.h>

#include <random>

#include <zwang/bench/scenes/catalog.h>

#include "tests/parameter_name.h"

namespace zwang {
namespace {

class ConePrograms : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    problem_ = make_scenes(GetParam()).at(0).problem;
    ASSERT_TRUE(problem_.has_tangents());
    ASSERT_TRUE(program_.build(problem_, ConeProgram::Want::way_back, {}, Deadline(), solution_));
    v_.setZero(program_.face().unknowns());
    y_ = random(program_.rows());
    program_.face().force(y_, v_);  // any motion
    y_ = random(program_.rows());
    for (Index i = 3 * program_.cones(); i < y_.size(); ++i) y_[i] = std::abs(y_[i]);
    program_.write(problem_, v_, y_, solution_);
  }
  Vector random(Index n) {
    return Vector::NullaryExpr(n, [&] { return std::uniform_real_distribution<double>(-1, 1)(generator_); });
  }

  Problem problem_;
  Solution solution_;
  ConeProgram program_;
  Vector v_, y_;
  std::mt19937 generator_{5};
};

TEST_P(ConePrograms, ReadingUndoesWriting) {
  Vector v, y;
  program_.read(problem_, solution_.z, solution_.lambda, v, y);
  EXPECT_LE((v - v_).norm(), 1e-9 * v_.norm());
  EXPECT_LE((y - y_).norm(), 1e-9 * y_.norm());
}

TEST_P(ConePrograms, SlacksAreThoseOfTheProblemsRows) {
  Vector s = Vector::Zero(program_.rows());
  program_.slack(v_, s);
  const Vector slack = problem_.J * solution_.z - problem_.c;
  Index k = 0;
  for (Index i = 0; i < problem_.rows(); ++i) {
    if (problem_.is_tangent(i) || problem_.tangents(i) != 2 || !(problem_.mu[i] > 0)) continue;
    ASSERT_LT(k, program_.cones());
    EXPECT_EQ(program_.mu(k), problem_.mu[i]);
    // (N / mu, T1, T2), all times one factor.
    const Vec3 own = s.segment<3>(3 * k), given(slack[i] / problem_.mu[i], slack[i + 1], slack[i + 2]);
    const double factor = own.norm() / given.norm();
    EXPECT_GT(factor, 0);
    EXPECT_LE((own - factor * given).norm(), 1e-9 * (own.norm() + factor * problem_.z_u.norm())) << k;
    ++k;
  }
  EXPECT_EQ(k, program_.cones());
}

TEST_P(ConePrograms, ForcesDoTheWorkOfSlacks) {
  Vector f = Vector::Zero(v_.size()), s = Vector::Zero(program_.rows());
  program_.face().force(y_, f);
  program_.face().slack(v_, s);
  EXPECT_NEAR(f.dot(v_), s.dot(y_), 1e-10 * f.norm() * v_.norm());
}

INSTANTIATE_TEST_SUITE_P(Form, ConePrograms,
                         testing::Values("hand(contacts=4,mu=.5,seed=2)", "tower(boxes=3,mu=.5)",
                                         "wall(boxes=60,mu=.75)"),
                         [](const auto& i) { return test::parameter_name(i.param); });

}  // namespace
}  // namespace zwang
