#include <zwang/core/problem/islands.h>

#include <gtest/gtest.h>

#include <zwang/bench/timing/allocations.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

// Unknowns 0..5. Rows couple {0, 3}, {1} and {4}; M couples {2, 5}; row 3 has no entries.
Problem scattered() {
  Problem p{.name = "scattered"};
  Matrix M = Matrix::Identity(6, 6);
  M(2, 5) = M(5, 2) = 0.5;
  p.M = M.sparseView();
  p.z_u = Vector::LinSpaced(6, -1, -6);
  Matrix J = Matrix::Zero(5, 6);
  J(0, 0) = 1, J(0, 3) = -1;
  J(1, 4) = 2;
  J(2, 1) = 1;
  J(4, 3) = 1;
  p.J = J.sparseView();
  p.c = Vector::LinSpaced(5, 1, 5);
  p.c[3] = -1;
  p.kind.assign(5, RowKind::inequality);
  p.kind[0] = RowKind::equality;
  for (std::uint64_t i = 0; i < 5; ++i) p.key.push_back({100 + i, 0});
  return p;
}

TEST(Islands, AreTheUnknownsCoupledThroughMAndJ) {
  Islands islands;
  islands.split(scattered());
  const auto all = islands.all();
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0].columns, (std::vector<Index>{0, 3}));
  EXPECT_EQ(all[0].rows, (std::vector<Index>{0, 3, 4})) << "the row without entries goes to the first island";
  EXPECT_EQ(all[1].columns, std::vector<Index>{1});
  EXPECT_EQ(all[2].columns, (std::vector<Index>{2, 5}));
  EXPECT_TRUE(all[2].rows.empty());
  EXPECT_EQ(all[3].columns, std::vector<Index>{4});
}

TEST(Islands, KeepEntriesKindsAndKeys) {
  const Problem p = scattered();
  Islands islands;
  islands.split(p);
  for (const Island& island : islands.all()) {
    require_matching_sizes(island.problem);
    EXPECT_EQ(bad_input(island.problem), "");
    for (std::size_t i = 0; i < island.rows.size(); ++i) {
      const Index row = island.rows[i];
      EXPECT_EQ(island.problem.key[i], p.key[static_cast<std::size_t>(row)]);
      EXPECT_EQ(island.problem.kind[i], p.kind[static_cast<std::size_t>(row)]);
      EXPECT_EQ(island.problem.c[static_cast<Index>(i)], p.c[row]);
      for (std::size_t k = 0; k < island.columns.size(); ++k)
        EXPECT_EQ(island.problem.J.coeff(static_cast<Index>(i), static_cast<Index>(k)),
                  p.J.coeff(row, island.columns[k]));
    }
  }
  EXPECT_EQ(islands.all()[2].problem.M.coeff(0, 1), 0.5);
}

TEST(Islands, StoredZerosCouple) {
  Problem p = scattered();
  p.J.coeffRef(1, 1) = 0;
  p.J.makeCompressed();
  Islands islands;
  islands.split(p);
  ASSERT_EQ(islands.all().size(), 3u);
  EXPECT_EQ(islands.all()[1].columns, (std::vector<Index>{1, 4}));
  EXPECT_EQ(islands.all()[1].problem.J.nonZeros(), 3);
}

// Islands 1 and 3 have one shape and share their storage; islands 0 and 2 lie among others.
TEST(Islands, CutOutForSolvingAreThoseOfTheSplit) {
  const Problem p = scattered();
  Islands split, apart;
  split.split(p);
  std::size_t k = 0;
  Solution whole;
  const auto check = [&](const Problem& part, const SolveOptions&, Solution& s) {
    ASSERT_LT(k, split.all().size());
    const Problem& expected = split.all()[k++].problem;
    EXPECT_EQ(Matrix(part.M), Matrix(expected.M));
    EXPECT_EQ(Matrix(part.J), Matrix(expected.J));
    EXPECT_EQ(part.z_u, expected.z_u);
    EXPECT_EQ(part.c, expected.c);
    EXPECT_EQ(part.kind, expected.kind);
    EXPECT_EQ(part.key, expected.key);
    s.reset(part.size(), part.rows());
    s.status = Status::solved;
    s.z = part.z_u;
    s.lambda = part.c;
  };
  for (int again = 0; again < 2; ++again) {
    k = 0;
    apart.solve_apart(check, 1, p, {}, whole);
    EXPECT_EQ(k, 4u);
    EXPECT_EQ(whole.z, p.z_u);
    EXPECT_EQ(whole.lambda, p.c);
  }
}

// The islands are kept from solve to solve: one entry that moves to another column must be seen.
TEST(Islands, CutOutForSolvingFollowAnEntryThatMoves) {
  Problem p = scattered();
  Islands apart;
  std::vector<Index> sizes;
  Solution whole;
  const auto note = [&](const Problem& part, const SolveOptions&, Solution& s) {
    sizes.push_back(part.size());
    s.reset(part.size(), part.rows());
    s.status = Status::solved;
  };
  apart.solve_apart(note, 1, p, {}, whole);
  EXPECT_EQ(sizes, (std::vector<Index>{2, 1, 2, 1}));

  Matrix J = p.J;
  std::swap(J(0, 3), J(0, 4));  // row 0 couples {0, 4}
  p.J = J.sparseView();
  sizes.clear();
  apart.solve_apart(note, 1, p, {}, whole);
  EXPECT_EQ(sizes, (std::vector<Index>{2, 1, 2, 1}));
  EXPECT_EQ(apart.all()[0].columns, (std::vector<Index>{0, 4}));

  Matrix M = p.M;
  std::swap(M(2, 5), M(2, 3));
  std::swap(M(5, 2), M(3, 2));
  p.M = M.sparseView();
  sizes.clear();
  apart.solve_apart(note, 1, p, {}, whole);
  EXPECT_EQ(apart.all()[2].columns, (std::vector<Index>{2, 3}));

  apart.split(p, 3);  // another use in between
  apart.solve_apart(note, 1, p, {}, whole);
  EXPECT_EQ(apart.all().size(), 4u);
}

TEST(Islands, SolvedApartGiveTheSolutionOfTheWhole) {
  const Problem p = scattered();
  AnySolver solver = make_solver("pgs");
  const SolveOptions options{.tolerance = 1e-13};
  const Solution whole = solver.solve(p, options);
  Solution joined;
  Islands islands;
  islands.solve_apart([&](const Problem& q, const SolveOptions& o, Solution& s) { solver.solve(q, o, s); }, 1, p,
                      options, joined);
  ASSERT_EQ(whole.status, Status::solved);
  EXPECT_EQ(joined.status, Status::solved);
  EXPECT_LE((joined.z - whole.z).norm(), 1e-12 * whole.z.norm());
  EXPECT_LE((joined.lambda - whole.lambda).norm(), 1e-12 * whole.lambda.norm());
}

// Fails on islands that have the unknown 2, says infeasible of those whose right-hand side is 2.
struct Scripted {
  static constexpr auto name = "scripted";
  void solve(const Problem& p, const SolveOptions&, Solution& out) {
    out.reset(p.size(), p.rows());
    out.status = Status::solved;
    out.z = p.z_u;
    out.lambda.setOnes();
    out.iterations = 3;
    if (p.rows() == 0) out.status = Status::iteration_limit, out.message = "gave up";
    if (p.rows() == 1 && p.c[0] == 2) {
      out.status = Status::infeasible;
      out.z.resize(0);
      out.certificate = Vector::Constant(1, 7);
    }
    if (p.rows() == 3) out.redundant = {2};
  }
};

TEST(Islands, TheWorstStatusAndTheCertificateAndTheRowNumbersAreThoseOfTheWhole) {
  AnySolver solver = Scripted{};
  Solution joined;
  Islands islands;
  islands.solve_apart([&](const Problem& q, const SolveOptions& o, Solution& s) { solver.solve(q, o, s); }, 1,
                      scattered(), {}, joined);
  EXPECT_EQ(joined.status, Status::infeasible);
  EXPECT_EQ(joined.z.size(), 0);
  EXPECT_EQ(joined.certificate, Vector(7 * Vector::Unit(5, 1)));
  EXPECT_EQ(joined.redundant, std::vector<Index>{4});
  EXPECT_EQ(joined.iterations, 12);
  EXPECT_EQ(joined.message, "island 3: gave up");
}

TEST(Islands, SplittingAgainAllocatesNothing) {
  const Problem p = scattered();
  Islands islands;
  islands.split(p);
  const long before = allocations();
  islands.split(p);
  EXPECT_EQ(allocations() - before, 0);
}

TEST(Islands, AProblemWithoutUnknownsIsOneIsland) {
  Problem p{.name = "rows only"};
  p.J.resize(1, 0);
  p.c = Vector::Ones(1);
  p.kind = {RowKind::equality};
  p.key = {{}};
  Islands islands;
  islands.split(p);
  ASSERT_EQ(islands.all().size(), 1u);
  EXPECT_EQ(islands.all()[0].rows, std::vector<Index>{0});
}

}  // namespace
}  // namespace zwang
