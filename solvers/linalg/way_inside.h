#pragma once

#include <zwang/core/problem/types.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace zwang {

// How far to go from a point along a motion that opens rows, until all are met whatever rounding hides; infinite where
// no way does. each(visit) calls visit(violated, opens) for each inequality row near the point: by how much it may be
// violated there, negative where it is open, and by how much the motion opens it for certain.
template <class Each>
double way_inside(Each&& each) {
  constexpr double none = std::numeric_limits<double>::infinity();
  double way = 0, most = none;
  each([&](double violated, double opens) {
    if (violated > 0)
      way = opens > 0 ? std::max(way, violated / opens) : none;
    else if (opens < 0)
      most = std::min(most, violated / opens);
  });
  way *= 1 + 2 * std::numeric_limits<double>::epsilon();  // as a quotient may be rounded down
  return way == 0 || way < most ? way : none;
}

// Sweeps (Motzkin & Schoenberg 1954) until y opens each unit row that is listed by a half at least, where that takes
// few. Of rows that repeat each other, a motion that opens those a method holds opens all, or not: by luck.
template <class Rows, class Motion>
void open_all(const Rows& rows, std::span<const Index> listed, Motion& y) {
  constexpr int most = 100;
  bool all = false;
  for (int sweep = 0; sweep < most && !all; ++sweep) {
    all = true;
    for (const Index i : listed) {
      const double opens = rows.dot(i, y);
      if (2 * opens >= 1) continue;
      rows.add(i, 1 - opens, y);
      all = false;
    }
  }
}

// How far the answer is from a point that meets all rows, from what its forces are out of balance by (M^-1-norm), and
// their work there, y's (promise.h).
inline double far_from(double unbalanced, double work) {
  return unbalanced / 2 + std::sqrt(unbalanced * unbalanced / 4 + work);
}

}  // namespace zwang
