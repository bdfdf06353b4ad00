#include <zwang/bench/references/reference.h>

#include <gtest/gtest.h>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include <zwang/bench/references/cache.h>
#include <zwang/bench/references/witnesses.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/solvers/active_set/dual_active_set.h>
#include "tests/folders.h"
#include "tests/recorded_data.h"
#include "tests/solvers/small_problems.h"

namespace zwang {
namespace {

using test::make_problem;
using test::vec;

// Entries -1, 0, 1 make ties, degenerate vertices, duplicated and contradicting rows the rule, not the exception.
Problem ternary_problem(unsigned seed) {
  std::mt19937 random(seed);
  const auto pick = [&](int low, int high) {
    return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
  };
  const int n = pick(1, 5), m = pick(0, 8), equalities = pick(0, 2);
  Vector mass(n), z_u(n);
  for (double& a : mass) a = std::ldexp(1.0, pick(-1, 1));
  for (double& a : z_u) a = pick(-2, 2);
  std::vector<test::Row> rows;
  for (int i = 0; i < m; ++i) {
    test::Row row{i < equalities ? RowKind::equality : RowKind::inequality, Vector(n),
                  static_cast<double>(pick(-1, 1))};
    for (double& a : row.J) a = pick(-1, 1);
    if (i > 0 && pick(0, 4) == 0) row.J = pick(0, 1) ? rows.back().J : Vector(-rows.back().J);
    rows.push_back(row);
  }
  Problem p = make_problem(mass, z_u, rows);
  p.name = "ternary " + std::to_string(seed);
  return p;
}

struct Folder {
  std::filesystem::path path = own_path("reference-test");
  Folder() { std::filesystem::remove_all(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  std::filesystem::path only_file() const { return std::filesystem::directory_iterator(path)->path(); }
};

TEST(Reference, DoubleAgreesWithHundredDigitsAndWithRationalsOnDegenerateProblems) {
  int infeasible = 0, degenerate = 0;
  DualActiveSet in_double;
  for (unsigned seed = 0; seed < 3000; ++seed) {
    const Problem p = ternary_problem(seed);
    const auto digits = multiprecision_reference(p), rational = rational_reference(p);
    ASSERT_TRUE(digits && rational) << p.name;
    ASSERT_EQ(digits->feasible, rational->feasible) << p.name;
    Solution s;
    in_double.solve(p, {}, s);
    ASSERT_EQ(s.status, digits->feasible ? Status::solved : Status::infeasible) << p.name;
    infeasible += !digits->feasible;
    degenerate += !s.redundant.empty();
    if (!digits->feasible) {
      EXPECT_LE(test::farkas_residual(p, digits->certificate), 1e-15) << p.name;
      EXPECT_LE(test::farkas_residual(p, s.certificate), 1e-13) << p.name;
      continue;
    }
    EXPECT_LE(relative_distance(p, rational->z, digits->z), 1e-15) << p.name;
    EXPECT_LE(relative_distance(p, rational->z, s.z), 1e-15) << p.name;
  }
  EXPECT_GT(infeasible, 300);
  EXPECT_GT(degenerate, 50);
}

// Joints that repeat each other, on coupled masses of 2^-20 to 2^20: what the mass's condition leaves of a hundred
// digits was once taken for a contradiction of 1e-95.
TEST(Reference, RepeatedJointsOfUnlikeMassesDoNotContradict) {
  const Problem rows = make_problem(Vector::Ones(4), vec({8, -7, 2, 0}),
                                    {{RowKind::equality, vec({0, 0, 0, 3}), -3},
                                     {RowKind::equality, vec({0, 2, -2, 0}), -2},
                                     {RowKind::equality, vec({0, 0, -1, 3}), -5},
                                     {RowKind::equality, vec({0, 0, -3, 0}), -6}});
  std::mt19937 random(4471);
  const auto pick = [&](int low, int high) {
    return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
  };
  for (int k = 0; k < 200; ++k) {
    Matrix A(4, 4);
    Vector d(4);
    for (double& a : A.reshaped()) a = pick(-2, 2);
    for (double& a : d) a = std::ldexp(1.0, pick(-10, 10));
    Problem p = rows;
    p.M = Matrix(d.asDiagonal() * (A * A.transpose() + Matrix::Identity(4, 4)) * d.asDiagonal()).sparseView();
    const auto digits = multiprecision_reference(p), rational = rational_reference(p);
    ASSERT_TRUE(digits && rational) << k;
    ASSERT_TRUE(digits->feasible && rational->feasible) << k;
    EXPECT_LE(relative_distance(p, rational->z, digits->z), 1e-14) << k;
  }
}

TEST(Reference, KeepsWhatTheInstanceBringsAndSaysWhetherItIsCertified) {
  Instance instance{.problem = test::tied_pair()};
  instance.reference = Reference{.z = vec({0, 0}), .lambda = vec({-40, 50}), .method = "closed form"};
  FoundReference found = reference_for(instance, {});
  ASSERT_TRUE(found.reference) << found.note;
  EXPECT_EQ(found.reference->method, "closed form, certified by the referee");
  EXPECT_EQ(found.reference->z, vec({0, 0}));

  // Once is enough.
  instance.reference = found.reference;
  EXPECT_EQ(reference_for(instance, {}).reference->method, found.reference->method);

  instance.problem = test::squeezed();
  instance.reference = Reference{.feasible = false, .method = "file"};
  found = reference_for(instance, {});
  ASSERT_TRUE(found.reference) << found.note;
  EXPECT_EQ(found.reference->method, "file") << "without Farkas' vector nothing is certified";
}

TEST(Reference, RefusesWhatTheInstanceBringsWhereItIsWrong) {
  Instance instance{.problem = test::tied_pair()};
  for (const double off : {7.0, 1e-9, 1e-12}) {
    instance.reference = Reference{.z = vec({off, off}), .method = "file"};
    const FoundReference found = reference_for(instance, {});
    EXPECT_FALSE(found.reference) << off;
    EXPECT_EQ(found.note, "the referee refutes the file");
    instance.reference->bound = off;
    EXPECT_TRUE(reference_for(instance, {}).reference) << "within its stated bound";
  }
  instance.reference = Reference{.feasible = false, .certificate = vec({1, 1}), .method = "file"};
  EXPECT_FALSE(reference_for(instance, {}).reference);
  instance.problem = test::squeezed();
  instance.reference = Reference{.z = Vector::Zero(instance.problem.size()), .method = "file"};
  EXPECT_FALSE(reference_for(instance, {}).reference);
}

TEST(Reference, IsComputedOnceAndKeptByContent) {
  const Folder folder;
  Instance instance{.problem = test::tied_pair()};
  const FoundReference first = reference_for(instance, folder.path, {.second_witness = true});
  ASSERT_TRUE(first.reference) << first.note;
  EXPECT_EQ(first.reference->method, "mpfr 100 digits, KKT certified in 100 digits + CGAL exact");
  EXPECT_EQ(first.reference->z, vec({0, 0}));
  EXPECT_EQ(first.reference->lambda, vec({-40, 50}));

  // A mark in the kept file shows that it is read; the same content under another name finds it.
  Reference marked = *first.reference;
  marked.method = "marked";
  marked.unique = false;
  write_cached(folder.only_file(), marked);
  EXPECT_FALSE(read_cached(folder.only_file())->unique);
  instance.problem.name = "another name";
  EXPECT_EQ(reference_for(instance, folder.path, {.second_witness = true}).reference->method, "marked");
  EXPECT_NE(folder.only_file().filename().string().find(reference_sources.substr(0, 16)), std::string::npos);
  instance.problem.c[0] = 1;
  EXPECT_EQ(reference_for(instance, folder.path, {.second_witness = true}).reference->method,
            "mpfr 100 digits, KKT certified in 100 digits + CGAL exact");
}

TEST(Reference, ComputesAgainWhereTheKeptFileIsTornOrAltered) {
  const Folder folder;
  const Instance instance{.problem = test::tied_pair()};
  ASSERT_TRUE(reference_for(instance, folder.path).reference);
  const auto file = folder.only_file();
  const auto size = std::filesystem::file_size(file);
  for (const auto length : {size / 2, std::uintmax_t{0}}) {
    std::filesystem::resize_file(file, length);
    EXPECT_FALSE(read_cached(file));
    const FoundReference again = reference_for(instance, folder.path);
    ASSERT_TRUE(again.reference);
    EXPECT_EQ(again.reference->z, vec({0, 0}));
    EXPECT_EQ(std::filesystem::file_size(file), size);
  }
  std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(40).put('\x7f');
  EXPECT_FALSE(read_cached(file));
}

// What another program wrote, with the right sum.
TEST(Reference, ComputesAgainWhatTheRefereeRefutes) {
  const Folder folder;
  const Instance instance{.problem = test::tied_pair()};
  const Reference right = *reference_for(instance, folder.path).reference;
  Reference moved = right;
  moved.z[0] += 1;
  for (const Reference& false_one : {moved, Reference{.feasible = false, .certificate = Vector::Ones(2)}}) {
    write_cached(folder.only_file(), false_one);
    const FoundReference again = reference_for(instance, folder.path);
    ASSERT_TRUE(again.reference && again.reference->feasible);
    EXPECT_EQ(again.reference->z, right.z);
  }
}

TEST(Reference, ProvesInfeasibility) {
  const FoundReference found = reference_for({.problem = test::squeezed()}, {}, {.second_witness = true});
  ASSERT_TRUE(found.reference) << found.note;
  EXPECT_FALSE(found.reference->feasible);
  EXPECT_EQ(test::farkas_residual(test::squeezed(), found.reference->certificate), 0);
}

TEST(Reference, IsNotGivenForAnIndefiniteMass) {
  Problem p = test::tied_pair();
  p.M.coeffRef(0, 0) = -1;
  const FoundReference found = reference_for({.problem = p}, {});
  EXPECT_FALSE(found.reference);
  EXPECT_NE(found.note, "");
}

TEST(Reference, DecidesRankDeficientContactsOfARealFile) {
  const std::filesystem::path file = test::recorded_data() / "contact_fclib/Capsules-i125-1213.hdf5";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const Instance instance = under(Law::frictionless, read_problems(file).front());
  const FoundReference found = reference_for(instance, {});
  ASSERT_TRUE(found.reference) << found.note;
  EXPECT_TRUE(found.reference->method.starts_with("mpfr 100 digits, KKT certified in 100 digits"));
  EXPECT_LE(found.reference->bound, 1e-13) << "z* rounded once";
  Solution s;
  DualActiveSet().solve(instance.problem, {}, s);
  EXPECT_LE(relative_distance(instance.problem, found.reference->z, s.z), 1e-12);
}

TEST(Reference, BeyondThreeHundredUnknownsCarriesAProvenBound) {
  const Problem p = test::tower(320);
  const FoundReference found = reference_for({.problem = p}, {});
  ASSERT_TRUE(found.reference) << found.note;
  EXPECT_EQ(found.reference->method, "long double, active-set bound");
  EXPECT_GT(found.reference->bound, 0);
  EXPECT_LE(found.reference->bound, 1e-9);
  EXPECT_LE(test::z_error(p, found.reference->z, Vector::Zero(320)), found.reference->bound);

  // The certificate behind it refuses a z that is off by more than the bound and what rounding explains.
  EXPECT_EQ(check_stored(p, *found.reference).standing, Standing::certified);
  Reference moved = *found.reference;
  moved.z[7] += 2 * (moved.bound + 1e-14) * std::sqrt(p.z_u.dot(p.M * p.z_u));
  EXPECT_EQ(check_stored(p, moved).standing, Standing::refuted);
  moved = *found.reference;
  moved.lambda[7] = -moved.lambda[7];
  EXPECT_EQ(check_stored(p, moved).standing, Standing::certified) << "lambda is a guess there: only z is certified";
}

}  // namespace
}  // namespace zwang
