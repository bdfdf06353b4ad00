#include <algorithm>
#include <cmath>
#include <limits>

#include <zwang/solvers/linalg/tolerances.h>
#include <zwang/solvers/newton/newton.h>

namespace zwang {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }
constexpr long double real_eps = std::numeric_limits<long double>::epsilon();

}  // namespace

// far_force_ = J'l - M d and violation_ = h - G d of the problem's stored doubles.
void Newton::extended_force(const Problem& p) {
  far_force_.setZero();
  for (const MassEntry& e : mass_) far_force_[e.row] -= Real(p.M.valuePtr()[e.from]) * far_d_[e.column];
  for (Index i = 0; i < rows_.rows(); ++i) {
    const Real norm = rows_.norm[i], l = far_l_[i] / norm;
    Real sum = 0;
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, rows_.row[at(i)]); it; ++it) {
      if (it.value() == 0) continue;
      const int j = factor_.position(static_cast<int>(it.col()));
      sum += Real(it.value()) * far_d_[j];
      far_force_[j] += Real(it.value()) * l;
    }
    violation_[i] = rows_.h[i] - sum / norm;
  }
}

bool Newton::polish(const Problem& p, const SolveOptions& options, const Deadline& deadline, Solution& s) {
  far_d_ = d_.cast<Real>();
  far_l_ = l_.cast<Real>();
  for (Index i = 0; i < rows_.rows(); ++i) weight_[i] = is_equality(i) || l_[i] > 0 ? s_ : 0;
  double last = std::numeric_limits<double>::infinity(), length = last, worst = 0;
  bool changed = true;
  for (int pass = 0; pass < 40; ++pass) {
    if (deadline.passed()) return false;
    extended_force(p);
    // Rows leave and enter.
    bool now_changed = false;
    for (Index i = 0; i < rows_.rows(); ++i) {
      if (is_equality(i)) continue;
      const double size = rows_.magnitude[i] + scale_;
      if (weight_[i] != 0 && far_l_[i] + Real(s_) * violation_[i] < -1e-15L * scale_) {
        weight_[i] = 0;
        now_changed = true;
      } else if (weight_[i] == 0 && violation_[i] > tolerances::wide_violation * real_eps * size) {
        weight_[i] = s_;
        now_changed = true;
      }
      if (weight_[i] == 0 && far_l_[i] != 0) {
        for (int e = rows_.g.begin[at(i)]; e < rows_.g.begin[at(i) + 1]; ++e)
          far_force_[place_[at(e)]] -= far_l_[i] * Real(rows_.g.value[at(e)]);
        far_l_[i] = 0;
      }
    }
    worst = 0;
    for (Index i = 0; i < rows_.rows(); ++i)
      if (weight_[i] != 0)
        worst = std::max(worst, static_cast<double>(std::abs(violation_[i])) / (rows_.magnitude[i] + scale_));
    if (!now_changed && !changed && length <= 1e-17 * scale_ && worst <= 8 * static_cast<double>(real_eps)) {
      write(p, s);
      s.redundant.assign(rows_.idle.begin(), rows_.idle.end());
      const double mu = (1 / std::clamp(rate_, 1e-16, 1.0) - 1) / s_;
      const double error = length + worst * scale_ / std::sqrt(std::max(mu, 1e-300));
      s.status = error <= accepted_error(options.tolerance) * scale_ ? Status::solved : Status::solved_ill_conditioned;
      return true;
    }
    changed = now_changed;
    if (changed || pass == 0) {
      if (!factorize(p, deadline)) return false;
      if (changed) ++s.iterations;
    }
    step_ = far_force_.cast<double>();
    for (Index i = 0; i < rows_.rows(); ++i)
      if (weight_[i] != 0) add_row(i, s_ * static_cast<double>(violation_[i]), step_);
    factor_.solve(step_);
    far_d_ += step_.cast<Real>();
    for (Index i = 0; i < rows_.rows(); ++i)
      if (weight_[i] != 0) far_l_[i] += Real(s_) * (violation_[i] - Real(row_dot(i, step_)));
    last = length;
    length = mass_norm(p, step_);
    if (!std::isfinite(length)) return false;
    if (!changed && last < std::numeric_limits<double>::infinity() && last > 1e-15 * scale_) rate_ = length / last;
  }
  return false;
}

// Where the rows contradict each other, l grows by s times the violations that no d can mend, and these are a Farkas
// vector: u >= 0 on inequality rows, G'u = 0, h'u > 0. What is left of G'u is taken out by the same contraction as in
// the polish, and the vector is judged as the referee will see it: rounded to double.
bool Newton::certify(const Problem& p, const Deadline& deadline, Solution& s) {
  far_d_.setZero();
  for (Index i = 0; i < rows_.rows(); ++i)
    far_l_[i] = is_equality(i) ? h_[i] - row_dot(i, d_) : weight_[i] != 0 ? std::max(0.0, h_[i] - row_dot(i, d_)) : 0;
  const Real least = 1e-9L * far_l_.lpNorm<Eigen::Infinity>();
  for (Index i = 0; i < rows_.rows(); ++i) {
    if (std::abs(far_l_[i]) <= least) far_l_[i] = 0;
    weight_[i] = far_l_[i] != 0 ? s_ : 0;
  }
  if (!factorize(p, deadline)) return false;
  for (int pass = 0; pass < 12; ++pass) {
    extended_force(p);
    step_ = far_force_.cast<double>();
    factor_.solve(step_);
    for (Index i = 0; i < rows_.rows(); ++i)
      if (weight_[i] != 0) far_l_[i] -= Real(s_) * row_dot(i, step_);
  }
  Real work = 0, noise = 0, weight = 0;
  double reach = reach_;
  whole_.setZero(p.size());
  certificate_.setZero(p.rows());
  for (Index i = 0; i < rows_.rows(); ++i) {
    if (!is_equality(i) && far_l_[i] < 0) far_l_[i] = 0;
    double& u = certificate_[rows_.row[at(i)]];
    u = static_cast<double>(far_l_[i] / Real(rows_.norm[i]));
    far_l_[i] = Real(u) * Real(rows_.norm[i]);
    work += far_l_[i] * rows_.h[i];
    noise += std::abs(far_l_[i]) * Real(rows_.magnitude[i]);
    weight += std::abs(far_l_[i]);
    if (u != 0) reach = std::max(reach, std::abs(h_[i]));
  }
  extended_force(p);
  for (int j = 0; j < factor_.size(); ++j) whole_[factor_.column(j)] = static_cast<double>(far_force_[j] / noise);
  if (p.size() > 0) rows_.factor.solve_lower(whole_);
  // More than the rows' own rounding is a way to meet them, however far away: solvers/common/polish.cpp.
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * static_cast<double>(weight / noise);
  if (whole_.norm() <= rounding && work > 8 * real_eps * noise &&
      static_cast<double>(work / noise) >= tolerances::out_of_reach * reach * whole_.norm()) {
    s.zero_certificate(p.rows()) = certificate_;
    s.status = Status::infeasible;
    return true;
  }
  return false;
}

}  // namespace zwang
