#pragma once

#include <zwang/solvers/form/unit_program.h>

namespace zwang {

// Worst |slack_i| (equality) or |min(lambda_i, slack_i)| (inequality): violation, sign and complementarity in one,
// without the square root that lambda_i slack_i hides. Like all lengths here over max(|z_u|_M, |z|_M). Allocates
// nothing.
inline double natural_residual(const UnitProgram& program, const Vector& y, const Vector& lambda) {
  double worst = 0;
  for (Index i = 0; i < program.rows(); ++i) {
    const double slack = program.dot(i, y) - program.h()[i];
    worst = std::max(worst, std::abs(program.is_equality(i) ? slack : std::min(lambda[i], slack)));
  }
  return worst / program.scale(y);
}

// The optimality conditions of a unit program, checked before a rival's answer is claimed solved: |y - G'lambda| and
// the natural residual. It is not the referee: core/referee/measure.h trusts nothing from here.
inline double kkt_residual(const UnitProgram& program, const Vector& y, const Vector& lambda) {
  const double stationarity = (y - program.G().transpose() * lambda).norm() / program.scale(y);
  return std::max(stationarity, natural_residual(program, y, lambda));  // NaN where y or lambda has one
}

}  // namespace zwang
