#include <zwang/solvers/friction/contact_sweeps.h>

#include <Eigen/LU>
#include <cmath>

#include <zwang/solvers/law/second_order_cone.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {
namespace {

// y in the standard cone with W y + b under Coulomb's law.
Vec3 solve_contact(const Mat3& W, const Vec3& b) {
  if (b[0] >= 0 || !(W(0, 0) > 0)) return Vec3::Zero();
  const auto at = [&](double a) -> Vec3 {
    Mat3 A = W;
    A(1, 1) += a;
    A(2, 2) += a;
    return A.inverse() * -b;
  };
  const auto outside = [](const Vec3& y) { return std::sqrt(y[1] * y[1] + y[2] * y[2]) - y[0]; };
  Vec3 y = at(0);
  if (y.allFinite() && outside(y) <= 0) return y;
  // a small enough to be outside, large enough to be inside; then bisection in the exponent, and false position.
  double low = 0, high = W.trace();
  while (outside(at(high)) > 0 && high < tolerances::horizon) high *= 16;
  double f_low = std::numeric_limits<double>::infinity(), f_high = outside(at(high));
  for (int step = 0; step < 200 && high - low > tolerances::cone_pivot * high; ++step) {
    const double middle = 0.5 * (low + high);
    double a = std::isfinite(f_low) ? high - f_high * (high - low) / (f_high - f_low) : middle;
    if (step % 3 == 2 || !(a > low && a < high)) a = middle;
    y = at(a);
    const double f = outside(y);
    if (f == 0) return y;
    (f > 0 ? low : high) = a;
    (f > 0 ? f_low : f_high) = f;
  }
  return second_order_cone::projected(at(high));
}

}  // namespace

bool ContactSweeps::begin(ConeProgram& program) {
  ConeFace& face = program.face();
  if (!face.divide_rows()) return false;
  const Index nc = program.cones();
  block_.resize(at(nc));
  diagonal_.resize(program.rays());
  for (Index k = 0; k < nc; ++k)
    for (Index i = 0; i < 3; ++i)
      for (Index j = 0; j < 3; ++j) block_[at(k)](i, j) = face.delassus(3 * k + i, 3 * k + j);
  for (Index r = 0; r < program.rays(); ++r) diagonal_[r] = face.delassus(3 * nc + r, 3 * nc + r);
  return true;
}

void ContactSweeps::sweep(ConeProgram& program, Vector& v, Vector& y) const {
  const ConeFace& face = program.face();
  const Index nc = program.cones();
  for (Index k = 0; k < nc; ++k) {
    const Mat3& W = block_[at(k)];
    Vec3 slack;
    for (Index i = 0; i < 3; ++i) slack[i] = face.along(3 * k + i, v) - program.h()[3 * k + i];
    const Vec3 before = y.segment<3>(3 * k), after = solve_contact(W, slack - W * before);
    y.segment<3>(3 * k) = after;
    for (Index i = 0; i < 3; ++i) face.push(3 * k + i, after[i] - before[i], v);
  }
  for (Index r = 3 * nc; r < program.rows(); ++r) {
    if (!(diagonal_[r - 3 * nc] > 0)) continue;
    const double slack = face.along(r, v) - program.h()[r], before = y[r];
    y[r] -= slack / diagonal_[r - 3 * nc];
    if (!program.is_equality(r - 3 * nc)) y[r] = std::max(0.0, y[r]);
    face.push(r, y[r] - before, v);
  }
}

}  // namespace zwang
