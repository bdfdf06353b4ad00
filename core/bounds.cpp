#include "core/bounds.h"

#include <algorithm>
#include <cmath>

namespace zwang {

DistanceBound bound_distance(const Gauge& gauge, const ExtendedVector& d, const ExtendedVector* lambda) {
  DistanceBound bound;
  if (!lambda) return bound;
  DoubleDouble weighted_slack;
  for (Index i = 0; i < gauge.rows(); ++i) {
    const DoubleDouble weight = (*lambda)[static_cast<std::size_t>(i)];
    if (gauge.is_vacuous(i)) continue;
    const DoubleDouble slack = gauge.slack(i, d);
    const bool equality = gauge.is_equality(i);
    if (slack.hi < 0 || (equality && slack.hi > 0) || (!equality && weight.hi < 0)) return bound;
    weighted_slack += weight * slack;
  }
  const double residual = gauge.dual_norm(gauge.force_residual(d, *lambda));
  bound.upper = std::sqrt(std::max(0.0, residual * residual + 2 * weighted_slack.hi));
  bound.method = "gap";
  bound.rows = DistanceBound::Rows::feasible;
  return bound;
}

}  // namespace zwang
