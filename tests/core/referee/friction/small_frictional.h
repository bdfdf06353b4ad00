#pragma once

#include <algorithm>
#include <initializer_list>
#include <utility>
#include <vector>

#include <zwang/core/problem/problem.h>
#include <zwang/core/referee/measure.h>

namespace zwang::test {

inline Vector vector(std::initializer_list<double> values) {
  Vector v(static_cast<Index>(values.size()));
  std::ranges::copy(values, v.begin());
  return v;
}

// A problem with M = I, contact by contact: rows are the normal and its tangents, c beside them.
struct SmallFrictional {
  struct Row {
    RowKind kind;
    Vector entries;
    double c, mu;
  };
  Vector z_u;
  std::vector<Row> rows = {};
  Vector mass = {};

  SmallFrictional& contact(double mu, std::initializer_list<std::pair<Vector, double>> block) {
    RowKind kind = RowKind::inequality;
    for (const auto& [entries, c] : block) {
      rows.push_back({kind, entries, c, kind == RowKind::inequality ? mu : 0});
      kind = RowKind::tangent;
    }
    return *this;
  }
  SmallFrictional& equality(const Vector& entries, double c) {
    rows.push_back({RowKind::equality, entries, c, 0});
    return *this;
  }
  Problem problem(Law law = Law::coulomb) const {
    const Index n = z_u.size();
    Problem p{.name = "small", .z_u = z_u, .law = law};
    const Vector diagonal = mass.size() == n ? mass : Vector::Ones(n);
    p.M = Matrix(diagonal.asDiagonal()).sparseView();
    Matrix J(static_cast<Index>(rows.size()), n);
    p.c.resize(J.rows());
    p.mu.resize(J.rows());
    for (Index i = 0; i < J.rows(); ++i) {
      const Row& row = rows[static_cast<std::size_t>(i)];
      if (n > 0) J.row(i) = row.entries;
      p.c[i] = row.c;
      p.mu[i] = row.mu;
      p.kind.push_back(row.kind);
      p.key.push_back({static_cast<std::uint64_t>(i) + 1, 0});
    }
    p.J = J.sparseView();
    return p;
  }
};

// The exact examples of docs/friction.md.
inline Problem rod(double mu) {
  return SmallFrictional{.z_u = vector({2, .25, 0})}
      .contact(mu, {{vector({0, 1, 1}), 0}, {vector({1, 0, 2}), 0}})
      .problem();
}
inline Problem wedge(double mu, double slip, double up) {
  return SmallFrictional{.z_u = vector({0, up})}
      .contact(mu, {{vector({-4, 3}), 0}, {vector({3, 4}), slip}})
      .contact(mu, {{vector({4, 3}), 0}, {vector({-3, 4}), slip}})
      .problem();
}
inline Problem pinch() {
  return SmallFrictional{.z_u = vector({0, 3})}
      .contact(1, {{vector({1, 0}), 0}, {vector({0, 1}), 1}})
      .contact(1, {{vector({-1, 0}), 0}, {vector({0, 1}), -1}})
      .problem();
}
// A block on a floor, sliding at `slip` under load `load`: z = (slip - mu load, 0) or stuck.
inline SmallFrictional block(double slip, double load, double mu) {
  return SmallFrictional{.z_u = vector({slip, 0, -load})}.contact(
      mu, {{vector({0, 0, 1}), 0}, {vector({1, 0, 0}), 0}, {vector({0, 1, 0}), 0}});
}

// Of z as a solver's claim, without a reference.
inline Metrics judge(const Problem& p, const Vector& z, const Vector& lambda = {}, double tolerance = 1e-13) {
  Solution s;
  s.status = Status::solved;
  s.z = z;
  s.lambda = lambda;
  return measure(p, s, nullptr, tolerance);
}

}  // namespace zwang::test
