#include <zwang/solvers/form/joint_tree.h>

#include <gtest/gtest.h>

#include "tests/solvers/random_mechanism.h"

namespace zwang {
namespace {

using test::Graph;
using Lanes = JointTree::Motion;

struct Tree {
  explicit Tree(const Problem& p) : fits(rows.build(p)) {
    if (fits) refused = tree.factorize(rows);
    if (holds()) tree.null_space(Nt);
  }
  bool holds() const { return fits && refused.empty(); }
  Index unknowns() const { return 6 * rows.bodies(); }
  // A unit row over all unknowns, and a motion as a vector of them.
  Vector row(Index i) const {
    Lanes part = Lanes::Zero(8, rows.bodies());
    rows.add(i, 1, part);
    return flat(part);
  }
  Vector flat(const Lanes& y) const { return y.topRows<6>().reshaped(); }
  Lanes lanes(const Vector& y) const {
    Lanes m = Lanes::Zero(8, rows.bodies());
    m.topRows<6>() = y.reshaped(6, rows.bodies());
    return m;
  }
  Matrix N() const { return Nt.topRows(tree.freedom()).transpose(); }

  BodyRows rows;
  JointTree tree;
  Matrix Nt;
  bool fits;
  std::string_view refused;
};

constexpr Graph tree_graphs[] = {Graph::floating_tree, Graph::grounded_tree, Graph::welds, Graph::loops, Graph::fans};

template <class Check>
void each_tree(Check&& check) {
  for (const Graph graph : tree_graphs) {
    int checked = 0;
    for (unsigned seed = 0; seed < test::seeds(graph, 60); ++seed) {
      const Problem p = test::random_mechanism(graph, seed, 0.5);
      const Tree t(p);
      EXPECT_TRUE(t.fits);
      if (!t.holds()) continue;
      ++checked;
      check(t, 1e-12 / t.tree.smallest_pivot());
    }
    EXPECT_GT(checked, static_cast<int>(test::seeds(graph, 40))) << static_cast<int>(graph);
  }
}

TEST(JointTree, ItsNullSpaceIsOrthonormalAndFreeOfTheTreesRows) {
  each_tree([](const Tree& t, double precision) {
    const Matrix N = t.N();
    EXPECT_EQ(N.cols() + static_cast<Index>(t.tree.tree_rows().size()), t.unknowns());
    EXPECT_LE((N.transpose() * N - Matrix::Identity(N.cols(), N.cols())).norm(), precision * N.cols());
    for (const Index i : t.tree.tree_rows()) EXPECT_LE((N.transpose() * t.row(i)).norm(), precision);
  });
}

TEST(JointTree, ReducesAndExpandsLikeTheNullSpaceItForms) {
  each_tree([](const Tree& t, double precision) {
    const Matrix N = t.N();
    const Vector y = Vector::LinSpaced(t.unknowns(), -1, 1), v = Vector::LinSpaced(N.cols(), 1, 2);
    Vector reduced(N.cols());
    Lanes expanded(8, t.rows.bodies());
    t.tree.reduce(t.lanes(y), reduced);
    t.tree.expand(v, expanded);
    EXPECT_LE((reduced - N.transpose() * y).norm(), precision * y.norm());
    EXPECT_LE((t.flat(expanded) - N * v).norm(), precision * v.norm());
    for (Index i = 0; i < t.rows.rows(); ++i) {
      const auto& bodies = t.rows.body[at(i)];
      Vector one = Vector::Zero(N.cols());
      t.tree.add_reduced(bodies, t.rows.part(i, 0), t.rows.part(i, bodies[1] < 0 ? 0 : 1), one.data());
      EXPECT_LE((one - N.transpose() * t.row(i)).norm(), precision);
    }
  });
}

TEST(JointTree, MeetsTheRowsShortlyAndReturnsTheirMultipliers) {
  each_tree([](const Tree& t, double precision) {
    const auto& listed = t.tree.tree_rows();
    const auto count = static_cast<Index>(listed.size());
    const Vector sigma = Vector::LinSpaced(count, -1, 1);
    Lanes met(8, t.rows.bodies()), shortest(8, t.rows.bodies());
    t.tree.meet(sigma, met);
    t.tree.shift(sigma, shortest);
    Vector force = Vector::Zero(t.unknowns());
    for (Index k = 0; k < count; ++k) {
      const Vector g = t.row(listed[static_cast<std::size_t>(k)]);
      EXPECT_NEAR(g.dot(t.flat(met)), sigma[k], precision * (1 + met.norm()));
      EXPECT_NEAR(g.dot(t.flat(shortest)), sigma[k], precision * (1 + shortest.norm()));
      force += sigma[k] * g;
    }
    EXPECT_LE(shortest.norm(), met.norm() * (1 + precision));
    EXPECT_LE((t.N().transpose() * t.flat(shortest)).norm(), precision * (1 + shortest.norm()));
    Vector mu(count);
    t.tree.multipliers(t.lanes(force), mu);
    EXPECT_LE((mu - sigma).norm(), precision * (1 + static_cast<double>(count)) / t.tree.smallest_pivot());
  });
}

TEST(JointTree, RefusesAJointWhoseRowsAreNearlyDependent) {
  Problem p = test::random_mechanism(Graph::floating_tree, 1, 0.5);
  Index first = -1, second = -1;
  for (Index i = 0; i + 1 < p.rows() && second < 0; ++i)
    if (p.is_equality(i) && p.is_equality(i + 1) && p.J.row(i).nonZeros() == 12 && p.J.row(i + 1).nonZeros() == 12) {
      Vector a = Vector(p.J.row(i).transpose()), b = Vector(p.J.row(i + 1).transpose());
      if (((a.array() != 0) == (b.array() != 0)).all()) first = i, second = i + 1;
    }
  ASSERT_GE(second, 0);
  Matrix J(p.J);
  J.row(second) = J.row(first) + 1e-8 * J.row(second);
  p.J = J.sparseView();
  const Tree t(p);
  EXPECT_FALSE(t.holds());
  EXPECT_NE(t.refused.find("nearly dependent"), std::string_view::npos);
}

}  // namespace
}  // namespace zwang
