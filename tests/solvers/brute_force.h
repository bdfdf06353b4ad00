#pragma once

#include <Eigen/Dense>
#include <optional>
#include <random>
#include <vector>

#include <zwang/core/problem/problem.h>

namespace zwang {

struct Kkt {
  Vector z, lambda;
};

// Every subset of the inequality rows is tried as the active set; the one whose KKT point is feasible with
// lambda_I >= 0 is the answer, none means infeasible. Extended precision, 2^m_I small factorizations: for m_I <= 10.
// Right to 1e-12 where active rows are not nearly dependent, which the random problems below keep to.
inline std::optional<Kkt> brute_force(const Problem& p) {
  using Real = long double;
  using V = VectorX<Real>;
  using A = MatrixX<Real>;
  const Index m = p.rows();
  const A M = A(p.M.cast<Real>()), J = A(MatrixX<double>(p.J).cast<Real>());
  const V z_u = p.z_u.cast<Real>(), c = p.c.cast<Real>();
  const Eigen::LLT<A> factor(M);
  const Real tolerance = 1e-13L * (1 + z_u.lpNorm<Eigen::Infinity>());
  std::vector<Index> equality, inequality;
  for (Index i = 0; i < m; ++i) (p.is_equality(i) ? equality : inequality).push_back(i);
  for (std::size_t subset = 0; subset < std::size_t{1} << inequality.size(); ++subset) {
    std::vector<Index> active = equality;
    for (std::size_t k = 0; k < inequality.size(); ++k)
      if (subset >> k & 1) active.push_back(inequality[k]);
    const Index a = static_cast<Index>(active.size());
    V z = z_u, lambda = V::Zero(m);
    if (a > 0) {
      const A J_a = J(active, Eigen::all);
      const A S = J_a * factor.solve(A(J_a.transpose()));
      const V l = S.fullPivLu().solve(V(c(active) - J_a * z_u));
      lambda(active) = l;
      z += factor.solve(V(J_a.transpose() * l));
    }
    const V slack = J * z - c;
    bool optimal = true;
    for (Index i = 0; i < m; ++i) {
      if (p.is_equality(i))
        optimal &= std::abs(slack[i]) <= tolerance;
      else
        optimal &=
            c[i] == -std::numeric_limits<Real>::infinity() || (slack[i] >= -tolerance && lambda[i] >= -tolerance);
    }
    if (optimal && z.allFinite()) return Kkt{z.cast<double>(), lambda.cast<double>()};
  }
  return std::nullopt;
}

// n <= 6 unknowns, at most 2 equality and 6 inequality rows, entries of order 1, M = L L' + I. Some problems have
// duplicated inequality rows; some are infeasible.
inline Problem random_small_problem(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> real(-1, 1);
  const auto pick = [&](int lo, int hi) {
    return lo + static_cast<int>(random() % static_cast<unsigned>(hi - lo + 1));
  };
  const int n = pick(2, 6), m_e = pick(0, std::min(2, n - 1)), m = m_e + pick(0, 6);
  Matrix L(n, n), J(m, n);
  for (double& a : L.reshaped()) a = real(random);
  for (double& a : J.reshaped()) a = real(random);
  for (int i = m_e + 1; i < m; ++i)
    if (pick(0, 5) == 0) J.row(i) = J.row(i - 1);
  Problem p{.name = "random " + std::to_string(seed)};
  const Matrix M = Matrix::Identity(n, n) + L.triangularView<Eigen::Lower>() * L.transpose();
  p.M = Matrix(0.5 * (M + M.transpose())).sparseView();
  p.J = J.sparseView();
  p.z_u.resize(n);
  p.c.resize(m);
  for (double& a : p.z_u) a = 3 * real(random);
  for (double& a : p.c) a = real(random);
  for (int i = 0; i < m; ++i) {
    p.kind.push_back(i < m_e ? RowKind::equality : RowKind::inequality);
    p.key.push_back({.constraint = static_cast<std::uint64_t>(i), .row = 0});
  }
  return p;
}

}  // namespace zwang
