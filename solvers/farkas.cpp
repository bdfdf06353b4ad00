#include "solvers/farkas.h"

namespace zwang {

bool proves_infeasible(const UnitProgram& program, Vector& u, Vector& motion) {
  program.project(u);
  const double gain = program.h().dot(u), rounding = 1e-14 * program.h().cwiseProduct(u).lpNorm<1>();
  if (!(gain > rounding) || !std::isfinite(gain)) return false;
  program.motion(u, motion);
  return gain >= 1e8 * program.reach() * motion.norm();
}

void sharpen(const UnitProgram& program, Vector& u) {
  constexpr Index most_entries = 1000000;
  Vector sharp = u;
  std::vector<Index> support;
  for (Index i = 0; i < u.size(); ++i) {
    if (std::abs(u[i]) > 1e-6 * u.lpNorm<Eigen::Infinity>())
      support.push_back(i);
    else
      sharp[i] = 0;
  }
  const Index count = static_cast<Index>(support.size());
  if (count == 0 || count * program.size() > most_entries) return;

  Matrix columns = Matrix::Zero(program.size(), count);
  for (Index j = 0; j < count; ++j)
    for (UnitProgram::Rows::InnerIterator it(program.G(), support[static_cast<std::size_t>(j)]); it; ++it)
      columns(it.col(), j) = it.value();
  Eigen::CompleteOrthogonalDecomposition<Matrix> factor;
  factor.setThreshold(1e-7);
  factor.compute(columns);
  Vector motion;
  for (int pass = 0; pass < 2; ++pass) {
    program.motion(sharp, motion);
    const Vector correction = factor.solve(motion);
    for (Index j = 0; j < count; ++j) sharp[support[static_cast<std::size_t>(j)]] -= correction[j];
  }
  Vector kept = sharp;
  if (proves_infeasible(program, kept, motion) && kept == sharp) u = sharp;
}

}  // namespace zwang
