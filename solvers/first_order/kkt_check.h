#pragma once

#include <zwang/solvers/common/unit_program.h>

namespace zwang {

// The optimality conditions of a unit program, checked by the methods before they claim success. Lengths are divided by
// max(|z_u|_M, |z|_M). It is not the referee: core/referee/measure.h trusts nothing from here.
struct KktCheck {
  double stationarity = 0;  // |y - G'lambda|
  double natural = 0;       // worst |slack_i| (equality), |min(lambda_i, slack_i)| (inequality): violation, sign and
                            // complementarity in one, without the square root that lambda_i slack_i hides
  Index worst_row = -1;     // of natural, in the unit program

  double worst() const { return std::max(stationarity, natural); }
};

inline KktCheck kkt_check(const UnitProgram& program, const Vector& y, const Vector& lambda) {
  KktCheck check;
  const double scale = program.scale(y);
  const Vector residual = y - program.G().transpose() * lambda;
  check.stationarity = residual.norm() / scale;
  for (Index i = 0; i < program.rows(); ++i) {
    const double slack = program.dot(i, y) - program.h()[i];
    const double natural = std::abs(program.is_equality(i) ? slack : std::min(lambda[i], slack)) / scale;
    if (natural > check.natural || std::isnan(natural)) {
      check.natural = natural;
      check.worst_row = i;
    }
  }
  return check;
}

// The natural residual alone, for methods whose y is G'lambda by construction. Allocates nothing.
inline double natural_residual(const UnitProgram& program, const Vector& y, const Vector& lambda) {
  double worst = 0;
  for (Index i = 0; i < program.rows(); ++i) {
    const double slack = program.dot(i, y) - program.h()[i];
    worst = std::max(worst, std::abs(program.is_equality(i) ? slack : std::min(lambda[i], slack)));
  }
  return worst / program.scale(y);
}

}  // namespace zwang
