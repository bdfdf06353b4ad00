#include <zwang/bench/fuzz/small_problem.h>

#include <array>
#include <cmath>
#include <limits>

#include <zwang/core/problem/row_writer.h>
#include <zwang/core/problem/wording.h>

namespace zwang {

std::uint64_t mix_bits(std::uint64_t seed, std::uint64_t number) {
  std::uint64_t x = seed * 0x9e3779b97f4a7c15u + number;
  for (const std::uint64_t factor : {0xbf58476d1ce4e5b9u, 0x94d049bb133111ebu}) {
    x ^= x >> 30;
    x *= factor;
    x ^= x >> 27;
  }
  return x;
}

Matrix coupled_mass(const Vector& D, int most, Draw& draw) {
  const Index n = D.size();
  Matrix L = Matrix::Identity(n, n);
  for (Index k = 0; k < n; ++k) {
    const Index i = draw.index(n), j = draw.index(n);
    if (i > j) L(i, j) = draw.integer(-most, most);
  }
  return L * D.asDiagonal() * L.transpose();
}

const DrawnRow& any_of(const std::vector<DrawnRow>& rows, Draw& draw) {
  return rows[at(draw.index(static_cast<Index>(rows.size())))];
}

void set_rows(Problem& p, const std::vector<DrawnRow>& rows, Index equalities) {
  RowWriter out;
  for (const DrawnRow& row : rows) {
    const Index i = out.rows();
    out.add(i < equalities ? RowKind::equality : RowKind::inequality, {static_cast<std::uint64_t>(i) + 1, 0}, row.c);
    out.entries(row.J);
  }
  out.write(p);
}

namespace {

Matrix mass(Index n, Draw& draw) {
  Vector D(n);
  for (double& d : D) d = std::exp2(draw.integer(-1, 1));
  return draw.integer(0, 2) == 0 ? coupled_mass(D, 1, draw) : Matrix(D.asDiagonal());
}

// A row of its own, or one made of the rows before it; its c mostly agrees with theirs.
DrawnRow compose_row(Index n, const std::vector<DrawnRow>& before, Draw& draw) {
  const int slip = draw.integer(0, 2) == 0 ? draw.integer(-1, 1) : 0;
  const int origin = before.empty() ? 0 : draw.integer(0, 9);
  if (origin >= 8) {
    const DrawnRow &a = any_of(before, draw), &b = before.back();
    return {a.J + b.J, a.c + b.c + slip};
  }
  if (origin >= 5) {
    constexpr std::array factors = {1., 1., -1., 2., -2., .5};
    const DrawnRow& a = any_of(before, draw);
    const double factor = factors[at(draw.integer(0, 5))];
    return {factor * a.J, factor * a.c + slip};
  }
  if (draw.integer(0, 19) == 0) return {Vector::Zero(n), static_cast<double>(draw.integer(-1, 1))};
  return {draw.integers(n, 1), static_cast<double>(draw.integer(-1, 1))};
}

// Rows made of rows that were made of rows must not grow without end.
DrawnRow draw_row(Index n, const std::vector<DrawnRow>& before, Draw& draw) {
  for (;;) {
    const DrawnRow row = compose_row(n, before, draw);
    const auto size = row.J.cwiseAbs().array();
    if ((size == 0 || (size >= .5 && size <= 4)).all()) return row;
  }
}

// Of near_problem().
constexpr int nearest = 50, farthest = 22;  // -log2 of what a copy is off by

Matrix near_mass(Index n, Draw& draw) {
  const int spread = 10 * draw.integer(0, 2);
  Vector D(n);
  for (double& d : D) d = std::exp2(draw.integer(-spread, spread));
  return draw.integer(0, 1) == 0 ? Matrix(D.asDiagonal()) : coupled_mass(D, 2, draw);
}

DrawnRow fresh(const Vector* met, bool equality, Index n, Draw& draw) {
  DrawnRow row{draw.integers(n, 3), 0};
  row.c = met ? row.J.dot(*met) : draw.integer(-3, 3);
  if (met && !equality && draw.integer(0, 1) == 1) row.c -= draw.integer(0, 2);
  return row;
}

// Of one row, or of the sum of two. c goes with J where a motion is to be met.
DrawnRow copy(const std::vector<DrawnRow>& before, const Vector* met, Index n, Draw& draw) {
  DrawnRow row = any_of(before, draw);
  if (draw.integer(0, 2) == 0) {
    const DrawnRow& other = any_of(before, draw);
    row = {row.J + other.J, row.c + other.c};
  }
  const double off = std::exp2(-draw.integer(farthest, nearest));
  const Vector direction = draw.integers(n, 2);
  if (draw.integer(0, 3) > 0) {
    row.J += off * direction;
    if (met) row.c += off * direction.dot(*met);
  }
  const int kind = draw.integer(0, 5);
  const double factor = kind == 0 ? -1 : kind <= 2 ? std::exp2(draw.integer(-3, 3)) : 1;
  row = {factor * row.J, factor * row.c};
  if (draw.integer(0, 3) == 0) row.c += factor * std::exp2(-draw.integer(20, 40)) * draw.integer(-1, 1);
  return row;
}

}  // namespace

Problem small_problem(std::uint64_t seed, std::uint64_t number, int most_unknowns, int most_rows) {
  Draw draw(mix_bits(seed, number));
  const Index n = draw.integer(1, most_unknowns), m = draw.integer(0, most_rows);
  const int equalities = draw.integer(0, std::min(3, static_cast<int>(m)));
  Problem p{.name = "fuzz " + std::to_string(seed) + " " + std::to_string(number), .M = mass(n, draw).sparseView()};
  p.z_u = draw.integers(n, 2);
  std::vector<DrawnRow> rows;
  std::vector<Index> unlimited;
  for (Index i = 0; i < m; ++i) {
    rows.push_back(draw_row(n, rows, draw));
    if (i >= equalities && draw.integer(0, 39) == 0) unlimited.push_back(i);
  }
  set_rows(p, rows, equalities);
  for (const Index i : unlimited) p.c[i] = -std::numeric_limits<double>::infinity();
  return p;
}

Problem near_problem(std::uint64_t seed, std::uint64_t number, Index most_unknowns) {
  Draw draw(static_cast<double>(mix_bits(seed, number) >> 11));
  const Index n = 2 + draw.index(most_unknowns - 1), m = 1 + draw.index(2 * n),
              equalities = draw.index(std::min(m, n / 2) + 1);
  Problem p{.name = "near " + std::to_string(seed) + " " + std::to_string(number),
            .M = near_mass(n, draw).sparseView()};
  p.z_u = draw.integers(n, 4);
  const Vector motion = draw.integers(n, 2);
  const Vector* const met = draw.integer(0, 2) > 0 ? &motion : nullptr;
  std::vector<DrawnRow> rows;
  for (Index i = 0; i < m; ++i) {
    const bool own = rows.empty() || draw.integer(0, 4) < 2;
    rows.push_back(own ? fresh(met, i < equalities, n, draw) : copy(rows, met, n, draw));
  }
  set_rows(p, rows, equalities);
  return p;
}

Spoilt spoil(Problem problem, std::uint64_t seed) {
  using Limits = std::numeric_limits<double>;
  constexpr double inf = Limits::infinity();
  constexpr std::array values = {Limits::quiet_NaN(), inf, -inf, Limits::denorm_min(), 0x1.8p-1060, 1e300, -1e300};
  Draw draw(mix_bits(seed, 1));
  const double value = values[at(draw.integer(0, 6))];
  Spoilt out{.problem = std::move(problem)};
  Problem& p = out.problem;
  const Index i = p.rows() > 0 ? draw.index(p.rows()) : 0, j = draw.index(p.size());
  out.bad = !std::isfinite(value);
  const auto set = [&](double& entry, const char* name, Index first, Index second) {
    const std::string place = std::to_string(first) + (second >= 0 ? ", " + std::to_string(second) + ")" : "]");
    out.what = name + place + printed(" = %g", value);
    entry = value;
  };
  const int way = p.rows() > 0 ? draw.integer(0, 3) : draw.integer(0, 1);
  if (way == 0) set(p.z_u[j], "z_u[", j, -1);
  if (way == 1) set(p.M.coeffRef(j, j), "M(", j, j), out.bad |= value < 1;  // negative, or too small to divide by
  if (way == 2) set(p.J.coeffRef(i, j), "J(", i, j);
  if (way == 3) set(p.c[i], "c[", i, -1), out.bad &= value != -inf || p.is_equality(i);
  return out;
}

}  // namespace zwang
