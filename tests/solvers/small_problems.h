#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include <zwang/core/problem/problem.h>
#include <zwang/core/problem/solver.h>

namespace zwang::test {

struct Row {
  RowKind kind;
  Vector J;
  double c;
};

// M = diag(mass), rows keyed 1, 2, 3, ...
inline Problem make_problem(const Vector& mass, const Vector& z_u, const std::vector<Row>& rows) {
  Problem p;
  const Index n = z_u.size(), m = static_cast<Index>(rows.size());
  p.M.resize(n, n);
  for (Index i = 0; i < n; ++i) p.M.insert(i, i) = mass[i];
  p.z_u = z_u;
  p.J.resize(m, n);
  p.c.resize(m);
  for (Index i = 0; i < m; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    for (Index j = 0; j < n; ++j)
      if (row.J[j] != 0) p.J.insert(i, j) = row.J[j];
    p.c[i] = row.c;
    p.kind.push_back(row.kind);
    p.key.push_back({static_cast<std::uint64_t>(i + 1), 0});
  }
  p.J.makeCompressed();
  return p;
}

inline Vector vec(std::initializer_list<double> values) {
  Vector v(static_cast<Index>(values.size()));
  std::copy(values.begin(), values.end(), v.data());
  return v;
}

// A stack of point masses, the lowest first, each pushing on the one below: z = 0 and lambda_i = g * mass above.
inline Problem tower(Index count, double ratio = 1, double gravity = 9.8125) {
  Vector mass = Vector::Ones(count);
  mass[count - 1] = ratio;
  std::vector<Row> rows;
  for (Index i = 0; i < count; ++i) {
    Vector J = Vector::Zero(count);
    J[i] = 1;
    if (i > 0) J[i - 1] = -1;
    rows.push_back({RowKind::inequality, J, 0});
  }
  return make_problem(mass, Vector::Constant(count, -gravity), rows);
}

// Two masses 1 and 4 tied by z_0 = z_1 that fall onto nothing but a floor under the first: by hand z = (0, 0),
// the floor carries 5 g and the tie -4 g: a pull, which a multiplier kept >= 0 could not transmit.
inline Problem tied_pair(double gravity = 10) {
  return make_problem(vec({1, 4}), vec({-gravity, -gravity}),
                      {{RowKind::equality, vec({1, -1}), 0}, {RowKind::inequality, vec({1, 0}), 0}});
}

// One mass between a floor that rises and a ceiling that does not: z >= 1 and -z >= 0.
inline Problem squeezed() {
  return make_problem(vec({2}), vec({0}), {{RowKind::inequality, vec({1}), 1}, {RowKind::inequality, vec({-1}), 0}});
}

// A zero row that asks for 0 >= 1.
inline Problem zero_row_conflict() { return make_problem(vec({1}), vec({0}), {{RowKind::inequality, vec({0}), 1}}); }

template <class Method>
Solution solve(const Problem& p, const SolveOptions& options = {}, Method method = {}) {
  Solution s;
  method.solve(p, options, s);
  return s;
}

// |z - expected|_M / max(|z_u|_M, |expected|_M), infinite where z is not a vector of numbers of that size.
inline double z_error(const Problem& p, const Vector& z, const Vector& expected) {
  const auto length = [&](const Vector& v) { return std::sqrt(v.dot(p.M * v)); };
  if (z.size() != expected.size()) return std::numeric_limits<double>::infinity();
  const double scale = std::max({length(p.z_u), length(expected), std::numeric_limits<double>::min()});
  const double error = length(z - expected) / scale;
  return std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
}

// How far u is from u_I >= 0, J'u = 0, c'u > 0, as |J'u| over c'u; infinite when a sign is wrong.
inline double farkas_residual(const Problem& p, const Vector& u) {
  if (u.size() != p.rows()) return std::numeric_limits<double>::infinity();
  for (Index i = 0; i < p.rows(); ++i)
    if (!p.is_equality(i) && u[i] < 0) return std::numeric_limits<double>::infinity();
  const double gain = p.c.dot(u);
  return gain > 0 ? (p.J.transpose() * u).norm() / gain : std::numeric_limits<double>::infinity();
}

}  // namespace zwang::test
