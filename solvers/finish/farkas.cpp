#include <zwang/solvers/finish/farkas.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

bool proves_infeasible(const UnitProgram& program, Vector& u, Vector& motion) {
  program.project(u);
  const double gain = program.h.dot(u), rounding = tolerances::proof_rounding * program.h.cwiseProduct(u).lpNorm<1>();
  if (!(gain > rounding) || !std::isfinite(gain)) return false;
  program.motion(u, motion);
  return gain >= tolerances::referee_reach * program.reach() * motion.norm();
}

// The shortest correction by an orthogonal basis of its equations, one for each unknown, those that depend on others
// left out. Tried before: Eigen's complete orthogonal decomposition, whose solve allocates.
void Sharpening::run(const UnitProgram& program, Vector& u) {
  constexpr Index most_entries = 1000000;
  sharp_.setZero(u.size());
  support_.clear();
  const double least = tolerances::sharp_part * (u.size() > 0 ? u.lpNorm<Eigen::Infinity>() : 0.0);
  for (Index i = 0; i < u.size(); ++i)
    if (std::abs(u[i]) > least) support_.push_back(i);
  const Index n = program.size(), count = std::ssize(support_);
  if (count == 0 || count * n > most_entries) return;

  equations_.setZero(count, n);
  part_.resize(count);
  for (Index j = 0; j < count; ++j) {
    part_[j] = u[support_[at(j)]];
    for (UnitProgram::Rows::InnerIterator it(program.G, support_[at(j)]); it; ++it)
      equations_(j, it.col()) = it.value();
  }
  qr_.reset(count, n);
  for (Index k = 0; k < n; ++k) qr_.append(equations_.col(k), tolerances::sharp_pivot);
  qr_.split(part_);
  for (Index j = 0; j < count; ++j) sharp_[support_[at(j)]] = qr_.remainder()[j];
  kept_ = sharp_;
  if (proves_infeasible(program, kept_, motion_) && kept_ == sharp_) u = sharp_;
}

}  // namespace zwang
