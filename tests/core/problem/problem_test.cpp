#include <zwang/core/problem/problem.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace zwang {
namespace {

// One point mass over the floor.
Problem falling_point() {
  Problem p{.name = "point"};
  p.M.resize(3, 3);
  p.M.setIdentity();
  p.z_u = Vec3(0, 0, -10);
  p.J.resize(1, 3);
  p.J.insert(0, 2) = 1;
  p.c = Vector::Zero(1);
  p.kind = {RowKind::inequality};
  p.key = {{}};
  return p;
}

TEST(Problem, AcceptsFiniteEntries) { EXPECT_EQ(bad_input(falling_point()), ""); }

TEST(Problem, NamesTheEntryThatIsNotFinite) {
  Problem p = falling_point();
  p.J.coeffRef(0, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(bad_input(p), "J(0, 2) is not a finite number");
}

// |J M^-1/2| of it has to fit a double.
TEST(Problem, NamesWhatIsTooLarge) {
  Problem p = falling_point();
  p.J.coeffRef(0, 2) = 0x1p990;
  EXPECT_EQ(bad_input(p), "");
  p.M.coeffRef(2, 2) = 0x1p-40;
  EXPECT_EQ(bad_input(p), "row 0 of J is too long: |J M^-1/2| is above 2^1000");
  p.M.coeffRef(2, 2) = 0x1p1010;
  EXPECT_EQ(bad_input(p), "M(2, 2) is above 2^1000: its square would overflow");
}

TEST(Problem, AllowsMinusInfinityOnInequalityRowsOnly) {
  Problem p = falling_point();
  p.c[0] = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(bad_input(p), "");
  p.kind[0] = RowKind::equality;
  EXPECT_EQ(bad_input(p), "c(0) is not a finite number");
}

TEST(Problem, NamesTheAsymmetricEntryOfM) {
  Problem p = falling_point();
  p.M.coeffRef(0, 1) = 0.5;
  EXPECT_EQ(bad_input(p), "M is not symmetric at (0, 1)");
}

// Bodies, masses with inertias of their own, and blocks of no usual size: each entry is spoilt, taken out or made tiny.
TEST(Problem, FindsEveryAsymmetricOrTinyEntryOfM) {
  Problem p{.name = "blocks"};
  std::vector<Eigen::Triplet<double>> entries;
  Index n = 0;
  for (const Index size : {6, 3, 1, 1, 1, 3, 2, 6, 4, 6, 1}) {
    for (Index i = n; i < n + size; ++i)
      for (Index j = n; j < n + size; ++j) entries.emplace_back(i, j, i == j ? 2 : 1.0 / double(i + j));
    n += size;
  }
  p.z_u.setZero(n);
  p.J.resize(0, n);
  const auto complaint = [&] {
    p.M.resize(n, n);
    p.M.setFromTriplets(entries.begin(), entries.end());
    return bad_input(p);
  };
  ASSERT_EQ(complaint(), "");
  const auto at = [](Index i, Index j) {
    return std::string("(").append(std::to_string(i)).append(", ").append(std::to_string(j)).append(")");
  };
  for (std::size_t e = 0; e < entries.size(); ++e) {
    const auto good = entries[e];
    const Index i = good.row(), j = good.col();
    if (i == j) {
      entries[e] = {good.row(), good.col(), 0x1p-970};
      EXPECT_EQ(complaint(), std::string("M").append(at(i, i)).append(" is below 2^-960: its inverse would overflow"));
    } else {
      const auto expect_asymmetric = [&](const std::string& text) {
        EXPECT_TRUE(text.starts_with("M is not symmetric")) << text;
        EXPECT_TRUE(text.ends_with(at(i, j)) || text.ends_with(at(j, i))) << i << ", " << j << ": " << text;
      };
      entries[e] = {good.row(), good.col(), std::nextafter(good.value(), 2)};
      expect_asymmetric(complaint());
      entries.erase(entries.begin() + std::ptrdiff_t(e));
      expect_asymmetric(complaint());
      entries.insert(entries.begin() + std::ptrdiff_t(e), good);
    }
    entries[e] = good;
  }
}

TEST(Problem, ThrowsOnMismatchedSizesAndSaysThem) {
  Problem p = falling_point();
  p.c.resize(2);
  try {
    require_matching_sizes(p);
    FAIL() << "nothing was thrown";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("c 2"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace zwang
