#pragma once

#include <span>

#include <zwang/solvers/form/whiten.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// Of multipliers t := (I + S / softness)^-1 t that were drawn at random, p passes leave at least what they do of the
// part along the shortest, which is taken to be promise_part of them or more: a choice, not a theorem. So the length
// of the shortest combination of rows is estimated, from below; 0 where one may be nearly nothing.
template <class Pass>
double least_share(const Vector& t, double softness, int most_passes, Pass one_pass) {
  const double start = t.norm(), vanished = tolerances::promise_vanished * start;
  double before = infinity, length = start;
  int pass = 0;
  for (; pass < most_passes && length > vanished && !(length > 0.9 * before); ++pass) {
    one_pass();
    before = length;
    length = t.norm();
  }
  if (!(length <= vanished)) return 0;
  if (length == 0) return 1;
  const double kept = std::pow(length / (tolerances::promise_part * start), 1.0 / pass);
  return std::sqrt(softness * std::clamp(1 / kept - 1, 1.0, 1 / softness));
}

// How far the answer is from a point that meets all rows, from what its forces are out of balance by (M^-1-norm), and
// their work there, y's (promise.h).
inline double far_from(double unbalanced, double work) {
  return unbalanced / 2 + std::sqrt(unbalanced * unbalanced / 4 + work);
}

// The same from a point that may violate rows: at one that meets all, whatever rounding hides, on the way along a
// motion of that length. No force of the answer needs to be known for that, and no row to be told from others. Infinite
// where no way opens all, each `loose` by that part of the length.
inline double bound_inside(std::span<const NearRow> near, double length, double unbalanced, double loose = 0) {
  double way = 0, most = infinity, work = 0;
  for (const NearRow& r : near) {
    const double opens = r.opens - loose * length;
    if (r.violated > 0)
      way = opens > 0 ? std::max(way, r.violated / opens) : infinity;
    else if (opens < 0)
      most = std::min(most, r.violated / opens);
  }
  way *= 1 + 2 * std::numeric_limits<double>::epsilon();  // as a quotient may be rounded down
  if (way > 0 && !(way < most)) return infinity;
  for (const NearRow& r : near)
    if (r.push > 0) work += r.push * std::max(0.0, r.met + way * std::max(0.0, r.opens + loose * length));
  return way * length + far_from(way * length + unbalanced, work);
}

// Sweeps (Motzkin & Schoenberg 1954) until a motion opens each row that pushes or touches by a half at least, where
// that takes few. Of rows that repeat each other, a motion that opens those a method holds opens all, or not: by luck.
template <class Rows, class Motion>
void open_all(const Rows& rows, std::span<NearRow> near, double touch, Motion& motion) {
  constexpr int most_sweeps = 100;
  bool all = false;
  for (int sweep = 0; !all; ++sweep) {
    all = true;
    for (NearRow& r : near) {
      r.opens = rows.dot(r.row, motion);
      if (2 * r.opens >= 1 || sweep == most_sweeps || (!(r.push > 0) && !(r.violated > -touch))) continue;
      rows.add(r.row, 1 - r.opens, motion);
      all = false;
    }
  }
}

}  // namespace zwang
