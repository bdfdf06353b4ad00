#include <zwang/bench/fuzz/near_problem.h>

#include <cmath>

#include <zwang/bench/fuzz/small_problem.h>
#include <zwang/bench/scenes/dyadic.h>

namespace zwang {
namespace {

constexpr int nearest = 50, farthest = 22;  // -log2 of what a copy is off by

Matrix near_mass(Index n, SmallNumbers& draw) {
  const int spread = 10 * draw.integer(0, 2);
  Vector D(n);
  for (double& d : D) d = std::exp2(draw.integer(-spread, spread));
  return draw.integer(0, 1) == 0 ? Matrix(D.asDiagonal()) : coupled_mass(D, 2, draw);
}

DrawnRow fresh(const Vector* met, bool equality, Index n, SmallNumbers& draw) {
  DrawnRow row{draw.integers(n, 3), 0};
  row.c = met ? row.J.dot(*met) : draw.integer(-3, 3);
  if (met && !equality && draw.integer(0, 1) == 1) row.c -= draw.integer(0, 2);
  return row;
}

// Of one row, or of the sum of two. c goes with J where a motion is to be met.
DrawnRow copy(const std::vector<DrawnRow>& before, const Vector* met, Index n, SmallNumbers& draw) {
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

Problem near_problem(std::uint64_t seed, std::uint64_t number, Index most_unknowns) {
  SmallNumbers draw(static_cast<double>(mix_bits(seed, number) >> 11));
  const Index n = 2 + draw.index(most_unknowns - 1), m = 1 + draw.index(2 * n), equalities = draw.index(std::min(m, n / 2) + 1);
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

}  // namespace zwang
