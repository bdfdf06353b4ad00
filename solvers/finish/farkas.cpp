#include <zwang/solvers/finish/farkas.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

bool proves_infeasible(const UnitProgram& program, Vector& u, Vector& motion) {
  program.project(u);
  const double gain = program.h().dot(u),
               rounding = tolerances::proof_rounding * program.h().cwiseProduct(u).lpNorm<1>();
  if (!(gain > rounding) || !std::isfinite(gain)) return false;
  program.motion(u, motion);
  return gain >= tolerances::referee_reach * program.reach() * motion.norm();
}

// The shortest correction by the QR factors of its equations, one for each unknown, those that depend on others left
// out. Tried before: Eigen's complete orthogonal decomposition, whose solve allocates.
void Sharpening::run(const UnitProgram& program, Vector& u) {
  constexpr Index most_entries = 1000000;
  sharp_ = u;
  support_.clear();
  const double least = tolerances::sharp_part * (u.size() > 0 ? u.lpNorm<Eigen::Infinity>() : 0.0);
  for (Index i = 0; i < u.size(); ++i) {
    if (std::abs(u[i]) > least)
      support_.push_back(i);
    else
      sharp_[i] = 0;
  }
  const Index n = program.size(), count = std::ssize(support_);
  if (count == 0 || count * n > most_entries) return;

  equations_.setZero(count, n);
  for (Index j = 0; j < count; ++j)
    for (UnitProgram::Rows::InnerIterator it(program.G(), support_[at(j)]); it; ++it)
      equations_(j, it.col()) = it.value();
  qr_.reset(count, n);
  unknown_.clear();
  for (Index k = 0; k < n; ++k)
    if (qr_.append(equations_.col(k), tolerances::sharp_pivot) > tolerances::sharp_pivot) unknown_.push_back(k);
  correction_.resize(count);
  part_.resize(std::min(n, count));
  auto part = part_.head(qr_.size());
  for (int pass = 0; pass < 2; ++pass) {
    program.motion(sharp_, motion_);
    for (Index k = 0; k < part.size(); ++k) part[k] = motion_[unknown_[at(k)]];
    qr_.solve_transposed(part);
    correction_.noalias() = qr_.Q() * part;
    for (Index j = 0; j < count; ++j) sharp_[support_[at(j)]] -= correction_[j];
  }
  kept_ = sharp_;
  if (proves_infeasible(program, kept_, motion_) && kept_ == sharp_) u = sharp_;
}

}  // namespace zwang
