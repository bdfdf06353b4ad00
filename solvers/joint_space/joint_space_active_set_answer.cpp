#include <algorithm>
#include <cmath>
#include <limits>

#include <zwang/solvers/joint_space/joint_space_active_set.h>

// The climb's point refined with residuals in the problem's own terms, and held against the rows outside.

namespace zwang {
namespace {

// What rounding mostly leaves of a row that the others determine exactly. More goes to the careful path.
constexpr double exact_share = 1e-16;
// A slack that rounding in double leaves no doubt about.
constexpr double clear_slack = 1e-12;
constexpr double fine = 0x1p-63, rounding = tolerances::wide_violation * fine;

}  // namespace

// (z, lambda) of the climb's point.
void JointSpaceActiveSet::begin_from_climb() {
  const BodyRows& rows = form_.rows();
  mu_ = climb_.u();
  rest_ = y_;
  for (Index k = 0; k < static_cast<Index>(climb_.active().size()); ++k) rows.add(active_row(k), -mu_[k], rest_);
  form_.multipliers(rest_, mu_E_);
  point_.begin(rows, y_);
  push(mu_E_, mu_);
}

void JointSpaceActiveSet::push(const Vector& mu_E, const Vector& mu_I) {
  for (std::size_t k = 0; k < form_.equalities().size(); ++k)
    point_.push(form_.rows(), form_.equalities()[k], mu_E[static_cast<Index>(k)]);
  for (Index j = 0; j < static_cast<Index>(climb_.active().size()); ++j)
    point_.push(form_.rows(), active_row(j), mu_I[j]);
}

// M (z_u - z) + J'lambda, whitened, and c - J z over the rows that hold with equality.
void JointSpaceActiveSet::compute_residuals() {
  const BodyRows& rows = form_.rows();
  point_.begin_force(rows);
  point_.add_rows(rows, form_.equalities(), sigma_E_.data());
  listed_.clear();
  for (Index j = 0; j < static_cast<Index>(climb_.active().size()); ++j) listed_.push_back(active_row(j));
  point_.add_rows(rows, listed_, sigma_I_.data());
  point_.whiten_force(rows, rho_);
}

// Solves dy - G_A'dmu = rho, G_A dy = sigma, and adds the correction. Returns its length: |dy|, or |rho| where only the
// multipliers were off (along a chain of ill-conditioned joints they lose more digits than y).
double JointSpaceActiveSet::correct() {
  const BodyRows& rows = form_.rows();
  const auto q = static_cast<Index>(climb_.active().size());
  form_.meet(sigma_E_, step_);
  rest_ = rho_ - step_;
  form_.reduce(rest_, s_v_);
  for (Index j = 0; j < q; ++j) sigma_I_[j] -= rows.dot(active_row(j), step_);
  const InverseFactor& factor = climb_.factor();
  factor.solve_transposed(sigma_I_);
  factor.project(s_v_, dv_);
  for (Index j = 0; j < q; ++j) sigma_I_[j] -= dv_[j];
  factor.combine(sigma_I_, dv_);
  dv_ += s_v_;
  factor.solve(sigma_I_);  // now dmu

  // Multipliers of the equality rows from what the rest leaves of dy - rho.
  form_.expand(dv_, rest_);
  step_ += rest_;
  rest_ = step_ - rho_;
  for (Index j = 0; j < q; ++j) rows.add(active_row(j), -sigma_I_[j], rest_);
  form_.multipliers(rest_, mu_E_);

  y_ += step_;
  mu_.head(q) += sigma_I_.head(q);
  push(mu_E_, sigma_I_);
  point_.move(rows, step_);
  return std::max(step_.norm(), rho_.norm());
}

bool JointSpaceActiveSet::refine() {
  constexpr int passes = 4;
  for (int pass = 0; pass < passes; ++pass) {
    compute_residuals();
    const double change = correct();
    const double size = y_.norm() + form_.rows().free_norm;
    // The next correction would be about change^2 / size.
    if (change * change <= std::numeric_limits<double>::epsilon() / 32 * size * size) return true;
  }
  return false;
}

// The rows outside the active set, from the problem's own J and c: rounding in an answer of long double is all they may
// be short of, and what that leaves open, until another row gives way, may not move z by more than `limit`, relative:
// the careful path's leaves_in_doubt(). A row that the joints and active rows determine has to hold by itself.
bool JointSpaceActiveSet::rest_holds(double limit) {
  const BodyRows& rows = form_.rows();
  const double length = y_.norm(), far = std::max(length, rows.free_norm);
  for (Index j = 0; j < static_cast<Index>(place_.size()); ++j) {
    if (is_active(j)) continue;
    const Index i = form_.inequalities()[static_cast<std::size_t>(j)];
    const double size = rows.magnitude[i] + length;
    if (rows.dot(i, y_) - rows.h[i] > clear_slack * size) continue;
    const double violation = point_.violation(rows, i);
    if (violation > rounding * size) return false;
    const double most = violation + fine * size;
    if (!(most > 0)) continue;
    take(j);
    const double share = climb_.share(place_[static_cast<std::size_t>(j)]), allowed = limit * far;
    if (most <= allowed * share || share * climb_.room() <= allowed) continue;
    if (share > exact_share || violation > rounding * point_.terms(rows, i)) return false;
  }
  return true;
}

}  // namespace zwang
