#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <zwang/core/problem/problem.h>
#include <zwang/core/problem/solver.h>

// Small problems with friction, and what their answers must meet, by hand: nothing here is shared with a solver or with
// the referee.
namespace zwang::test {

struct FrictionRow {
  RowKind kind;
  Vector J;
  double c;
  double mu = 0;
};

inline Problem friction_problem(const Vector& mass, const Vector& z_u, const std::vector<FrictionRow>& rows,
                                Law law = Law::coulomb) {
  Problem p;
  const auto n = z_u.size(), m = static_cast<Index>(rows.size());
  p.M.resize(n, n);
  for (Index i = 0; i < n; ++i) p.M.insert(i, i) = mass[i];
  p.M.makeCompressed();
  p.z_u = z_u;
  p.J.resize(m, n);
  p.c.resize(m);
  p.mu.setZero(m);
  for (Index i = 0; i < m; ++i) {
    const FrictionRow& row = rows[static_cast<std::size_t>(i)];
    for (Index j = 0; j < n; ++j)
      if (row.J[j] != 0) p.J.insert(i, j) = row.J[j];
    p.c[i] = row.c;
    p.mu[i] = row.mu;
    p.kind.push_back(row.kind);
    p.key.push_back({static_cast<std::uint64_t>(i + 1), 0});
  }
  p.J.makeCompressed();
  p.law = law;
  return p;
}

// The largest of |M (z - z_u) - J'lambda| over |J'lambda| and |M z_u|, and of what the law leaves over the size of s
// and lambda of its contact: 0 at an answer. Diagonal M.
inline double law_error(const Problem& p, const Solution& answer) {
  using Real = long double;
  const auto n = p.size();
  std::vector<Real> force(static_cast<std::size_t>(n), 0), s(static_cast<std::size_t>(p.rows()));
  for (Index i = 0; i < p.rows(); ++i) {
    Real sum = -Real(p.c[i]);
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, i); it; ++it) {
      sum += Real(it.value()) * answer.z[it.col()];
      force[static_cast<std::size_t>(it.col())] += Real(it.value()) * answer.lambda[i];
    }
    s[static_cast<std::size_t>(i)] = sum;
  }
  Real worst = 0, size = 1e-300L;
  for (Index j = 0; j < n; ++j)
    size = std::max({size, std::abs(force[static_cast<std::size_t>(j)]), std::abs(p.M.coeff(j, j) * Real(p.z_u[j]))});
  for (Index j = 0; j < n; ++j)
    worst = std::max(
        worst, std::abs(p.M.coeff(j, j) * (Real(answer.z[j]) - p.z_u[j]) - force[static_cast<std::size_t>(j)]) / size);
  Real z_size = std::max<Real>(answer.z.lpNorm<Eigen::Infinity>(), p.z_u.lpNorm<Eigen::Infinity>());
  // Forces against rows of length near 1; no forces at all are judged by what moves the bodies.
  const Real l_size = std::max<Real>(answer.lambda.lpNorm<Eigen::Infinity>(), size);
  z_size = std::max<Real>(z_size, 1e-300L);
  for (Index i = 0; i < p.rows(); ++i) {
    if (p.is_tangent(i)) continue;
    const Real l = answer.lambda[i], own = s[static_cast<std::size_t>(i)];
    if (p.is_equality(i)) {
      worst = std::max(worst, std::abs(own) / z_size);
      continue;
    }
    const Index t = p.has_tangents() ? p.tangents(i) : 0;
    Real slip = 0, pull = 0, work = 0;
    for (Index k = i + 1; k <= i + t; ++k) {
      slip = std::hypot(slip, s[static_cast<std::size_t>(k)]);
      pull = std::hypot(pull, Real(answer.lambda[k]));
      work += s[static_cast<std::size_t>(k)] * answer.lambda[k];
    }
    const Real mu = t > 0 ? p.mu[i] : 0;
    const Real shifted = own + (p.law == Law::coulomb ? mu * slip : 0);
    worst = std::max({worst, -l / l_size, (pull - mu * l) / l_size, (mu * slip - shifted) / z_size,
                      std::abs(l * shifted + work) / (l_size * z_size)});
  }
  return static_cast<double>(worst);
}

// A problem with an answer planted in small dyadic numbers: contacts of every mode, masses powers of two, frames of
// integer quaternions (columns of a rotation times |q|^2), lever arms in eighths.
struct Planted {
  Problem problem;
  Vector z, lambda;
};

inline Planted planted(Law law, double mu, int bodies, int contacts, unsigned seed) {
  std::mt19937_64 random(seed);
  const auto pick = [&](int low, int high) {
    return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
  };
  const Index n = 6 * bodies;
  Vector mass(n), z(n);
  for (Index i = 0; i < n; ++i) {
    mass[i] = std::ldexp(1.0, pick(-2, 2));
    z[i] = pick(-16, 16) / 16.0;
  }
  std::vector<FrictionRow> rows;
  std::vector<double> slack;
  Vector lambda(3 * contacts);
  for (int k = 0; k < contacts; ++k) {
    const double a = pick(-2, 2), b = pick(-2, 2), c = pick(-2, 2), d = pick(1, 2);
    Mat3 R;
    R << a * a + d * d - b * b - c * c, 2 * (a * b - c * d), 2 * (a * c + b * d), 2 * (a * b + c * d),
        b * b + d * d - a * a - c * c, 2 * (b * c - a * d), 2 * (a * c - b * d), 2 * (b * c + a * d),
        c * c + d * d - a * a - b * b;
    const int first = pick(0, bodies - 1), second = bodies > 1 && pick(0, 1) ? (first + 1) % bodies : -1;
    Vec3 arm;  // drawn by entry: C++ orders no arguments
    for (const int i : {2, 1, 0}) arm[i] = pick(-8, 8) / 8.0;
    for (int q = 0; q < 3; ++q) {
      Vector J = Vector::Zero(n);
      const Vec3 axis = R.col(q), turn = arm.cross(axis);
      J.segment<3>(6 * first) = axis;
      J.segment<3>(6 * first + 3) = turn;
      if (second >= 0) {
        J.segment<3>(6 * second) = -axis;
        J.segment<3>(6 * second + 3) = turn;
      }
      rows.push_back({q == 0 ? RowKind::inequality : RowKind::tangent, J, 0, q == 0 ? mu : 0});
    }
    const int mode = pick(0, 2);
    const double f = std::ldexp(5.0, pick(-2, 2)), g = std::ldexp(1.0, pick(-2, 2));
    Vec3 s = Vec3::Zero(), l = Vec3::Zero();
    if (mode == 0) {
      s[0] = g;
      for (const int i : {2, 1}) s[i] = pick(-4, 4) / 4.0;
      if (law == Law::convex) s[0] += mu * (std::abs(s[1]) + std::abs(s[2]));
    } else if (mode == 1) {
      s = g * Vec3(law == Law::convex ? 5 * mu : 0, 3, 4);
      l = f * Vec3(1, -mu * 0.6, -mu * 0.8);
    } else {
      const double share = mu * pick(0, 3) / 4.0;
      l = f * Vec3(1, 0.6 * share, 0.8 * share);
    }
    lambda.segment<3>(3 * k) = l;
    slack.insert(slack.end(), {s[0], s[1], s[2]});
  }
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].c = rows[i].J.dot(z) - slack[i];
  Problem p = friction_problem(mass, z, rows, law);
  p.z_u = z - Vector((p.J.transpose() * lambda).cwiseQuotient(mass));
  return {p, z, lambda};
}

}  // namespace zwang::test
