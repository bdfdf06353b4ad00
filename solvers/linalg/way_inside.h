#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

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

// How far the answer is from a point that meets all rows, from what its forces are out of balance by (M^-1-norm), and
// their work there, y's (promise.h).
inline double far_from(double unbalanced, double work) {
  return unbalanced / 2 + std::sqrt(unbalanced * unbalanced / 4 + work);
}

}  // namespace zwang
