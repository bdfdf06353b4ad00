#include <zwang/solvers/friction/nsgs.h>

#include <Eigen/LU>
#include <cmath>

#include <zwang/solvers/law/second_order_cone.h>
#include <zwang/solvers/linalg/lanes.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {
namespace {

constexpr Index most_unknowns = 1000;

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
  y = at(high);
  return second_order_cone::projected(y);
}

}  // namespace

std::string Nsgs::supports(const Problem& problem) const {
  if (!problem.has_tangents()) return "no contact with friction";
  return problem.size() <= most_unknowns ? "" : "more than 1000 unknowns";
}

void Nsgs::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  ConeIteration iteration(inner, problem, options, solution);
  if (!iteration.begin()) return;
  ConeProgram& program = inner.program;
  if (!program.is_dense()) {
    solution.status = Status::unsupported;
    solution.message = "more than 150 unknowns and sparse rows";
    return;
  }
  DenseFace& face = program.dense_face();
  Vector &v = inner.v, &y = inner.y;
  const Index nc = program.cones(), padded = face.padded();
  block.resize(static_cast<std::size_t>(nc));
  diagonal.resize(program.rays());
  for (Index k = 0; k < nc; ++k)
    for (Index i = 0; i < 3; ++i)
      for (Index j = 0; j < 3; ++j)
        block[static_cast<std::size_t>(k)](i, j) = lanes::dot(face.row(3 * k + i), face.row(3 * k + j), padded);
  for (Index r = 0; r < program.rays(); ++r)
    diagonal[r] = lanes::dot(face.row(3 * nc + r), face.row(3 * nc + r), padded);
  while (iteration.goes_on(max_sweeps)) {
    for (Index k = 0; k < nc; ++k) {
      const Mat3& W = block[static_cast<std::size_t>(k)];
      Vec3 slack;
      for (Index i = 0; i < 3; ++i)
        slack[i] = lanes::dot(face.row(3 * k + i), v.data(), padded) - program.h()[3 * k + i];
      const Vec3 before = y.segment<3>(3 * k), after = solve_contact(W, slack - W * before);
      y.segment<3>(3 * k) = after;
      for (Index i = 0; i < 3; ++i) lanes::add(after[i] - before[i], face.row(3 * k + i), v.data(), padded);
    }
    for (Index r = 3 * nc; r < program.rows(); ++r) {
      if (!(diagonal[r - 3 * nc] > 0)) continue;
      const double slack = lanes::dot(face.row(r), v.data(), padded) - program.h()[r], before = y[r];
      y[r] -= slack / diagonal[r - 3 * nc];
      if (!program.is_equality(r - 3 * nc)) y[r] = std::max(0.0, y[r]);
      lanes::add(y[r] - before, face.row(r), v.data(), padded);
    }
    if (iteration.step_done()) break;
  }
  iteration.end();
}

}  // namespace zwang
