#pragma once

#include <random>

#include <zwang/core/problem/problem.h>

namespace zwang::test {

// Fans: a dozen bodies on each of two hubs, or all on one.
enum class Graph { floating_tree, grounded_tree, loops, welds, redundant_joints, fans };
inline constexpr Graph graphs[] = {Graph::floating_tree, Graph::grounded_tree,    Graph::loops,
                                   Graph::welds,         Graph::redundant_joints, Graph::fans};

// Of the seeds that small mechanisms are worth: dense methods take a hundred times as long over fans.
inline constexpr unsigned seeds(Graph graph, unsigned usual) { return graph == Graph::fans ? usual / 20 : usual; }

// Bodies with full random inertia, joints of random rows over random pairs, rows on one or two bodies pressed against.
// Masses spread by exp(spread N(0, 1)). Feasible: every c is met by one random motion.
inline Problem random_mechanism(Graph graph, unsigned seed, double spread = 2) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto uniform = [&](int most) { return static_cast<int>(random() % static_cast<unsigned>(most)); };
  const bool fans = graph == Graph::fans;
  const int bodies = (fans ? 24 : 2) + uniform(9), n = 6 * bodies;
  std::vector<Eigen::Triplet<double>> M, J;
  for (int b = 0; b < bodies; ++b) {
    const Mat<double, 6, 6> A = Mat<double, 6, 6>::NullaryExpr([&] { return normal(random); });
    const Mat<double, 6, 6> block =
        std::exp(spread * normal(random)) * (A * A.transpose() + Mat<double, 6, 6>::Identity());
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) M.emplace_back(6 * b + i, 6 * b + j, block(i, j));
  }
  Problem p;
  std::vector<RowKind>& kind = p.kind;
  const auto add_row = [&](int a, int b, RowKind type) {
    const int row = static_cast<int>(kind.size());
    for (const int body : {std::min(a, b), std::max(a, b)})
      for (int i = 0; i < 6 && body >= 0; ++i) J.emplace_back(row, 6 * body + i, normal(random));
    kind.push_back(type);
  };
  const auto add_joint = [&](int a, int b, int rows) {
    for (int k = 0; k < rows; ++k) add_row(a, b, RowKind::equality);
  };
  if (graph == Graph::grounded_tree || fans) add_joint(0, -1, 1 + uniform(6));
  for (int b = 1; b < bodies && fans; ++b) add_joint(b < 3 || seed % 2 ? 0 : 1 + b % 2, b, 3);
  for (int b = 1; b < bodies && !fans; ++b) {
    const int rows = graph == Graph::welds ? 6 : 1 + uniform(5);  // drawn by name: C++ orders no arguments
    add_joint(uniform(b), b, rows);
  }
  if (graph == Graph::loops)
    for (int k = 0; k < 2; ++k)
      if (const int a = uniform(bodies), b = uniform(bodies); a != b) add_joint(a, b, 1 + uniform(2));
  const int contacts = uniform(4 * bodies);
  for (int k = 0; k < contacts; ++k) {
    const int other = uniform(3) ? -1 : uniform(bodies);
    add_row(uniform(bodies), other, RowKind::inequality);
  }
  const int given = static_cast<int>(kind.size());
  const int copied = graph == Graph::redundant_joints ? 1 + uniform(3) : 0;
  std::vector<Eigen::Triplet<double>> copies;
  for (int k = 0; k < copied; ++k) {
    const int from = uniform(bodies - 1);
    for (const auto& entry : J)
      if (entry.row() == from) copies.emplace_back(given + k, entry.col(), 2 * entry.value());
    kind.push_back(RowKind::equality);
  }
  J.insert(J.end(), copies.begin(), copies.end());
  const auto m = static_cast<Index>(kind.size());
  p.name = "mechanism " + std::to_string(seed);
  p.M.resize(n, n);
  p.M.setFromTriplets(M.begin(), M.end());
  p.J.resize(m, n);
  p.J.setFromTriplets(J.begin(), J.end());  // a contact of a body with itself becomes one row of sums
  p.z_u = Vector::NullaryExpr(n, [&] { return normal(random); });
  const Vector z = Vector::NullaryExpr(n, [&] { return normal(random); });
  p.c = p.J * z;
  for (Index i = 0; i < m; ++i) {
    p.key.push_back({static_cast<std::uint64_t>(i), 0});
    if (!p.is_equality(i) && uniform(2)) p.c[i] -= std::abs(normal(random));
  }
  for (int k = 0; k < copied; ++k) {
    Index from = 0;
    for (Index i = 0; i < given; ++i)
      if ((2 * p.J.row(i) - p.J.row(given + k)).norm() == 0) from = i;
    p.c[given + k] = 2 * p.c[from];
  }
  return p;
}

// |a - b|_M as a share of |z_u|_M.
inline double distance(const Problem& p, const Vector& a, const Vector& b) {
  return std::sqrt((a - b).dot(p.M * (a - b))) / std::sqrt(p.z_u.dot(p.M * p.z_u));
}

}  // namespace zwang::test
