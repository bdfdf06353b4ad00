#include "solvers/reduced_active_set.h"

#include <cmath>
#include <limits>

namespace zwang {
namespace {

// Pivots and remainders between these could go either way by the rounding of N.
constexpr double clear_accepted = 1e-6, clear_rejected = 4e-15;
// A slack that rounding in double leaves no doubt about.
constexpr double clear_slack = 1e-12;
constexpr double fine = 0x1p-63, rounding = 32 * fine;

}  // namespace

bool ReducedActiveSet::clearly_independent() const {
  return climb_.smallest_accepted >= clear_accepted && climb_.largest_rejected <= clear_rejected;
}

// Row j of the reduced problem.
void ReducedActiveSet::fill(Index j) {
  const Index i = form_.inequalities()[static_cast<std::size_t>(j)];
  form_.reduce_row(i, climb_.row(j).data());
  climb_.b[j] = form_.rows().h[i] - form_.rows().dot(i, form_.y_E());
  climb_.magnitude[j] = form_.rows().magnitude[i];
}

void ReducedActiveSet::complete() {
  if (complete_) return;
  complete_ = true;
  if (climb_.rows() > 0) form_.form_basis();
  for (Index j = 0; j < climb_.rows(); ++j) fill(j);
  climb_.complete();
}

bool ReducedActiveSet::prepare(const Problem& p) {
  reason_ = {};
  complete_ = false;
  if (!form_.build(p)) return refuse(form_.reason());
  if (form_.smallest_pivot() < clear_accepted) return refuse("nearly dependent joints");
  climb_.reset(form_.freedom(), static_cast<Index>(form_.inequalities().size()));
  climb_.fixed_length = form_.y_E().norm();
  const Index bodies = form_.rows().bodies(), padded = climb_.padded();
  for (Motion* part : {&y_, &step_, &rest_, &rho_}) part->resize(BodyRows::lanes, bodies);
  for (Vector* part : {&mu_E_, &sigma_E_}) part->resize(static_cast<Index>(form_.equalities().size()));
  for (Vector* part : {&mu_, &sigma_I_, &dv_, &s_v_, &v_}) part->setZero(padded);
  return true;
}

// A row that the joints leave nothing of is noise, which a method would take for a row: it is idle (c = -Inf), and
// finish() judges it.
void ReducedActiveSet::state(const Problem& p, Problem& reduced) {
  constexpr double nothing = 1e-13;
  complete();
  const Index f = climb_.freedom(), m = climb_.rows();
  reduced.name = p.name;
  if (reduced.M.rows() != f) {
    reduced.M.resize(f, f);
    reduced.M.setIdentity();
    reduced.z_u.setZero(f);
  }
  reduced.c.resize(m);
  reduced.kind.assign(static_cast<std::size_t>(m), RowKind::inequality);
  reduced.key.resize(static_cast<std::size_t>(m));
  auto& J = reduced.J;
  if (J.rows() != m || J.cols() != f) J.resize(m, f);
  J.resizeNonZeros(m * f);
  int entries = 0;
  for (Index j = 0; j < m; ++j) {
    const auto a = climb_.row(j).head(f);
    const Index i = form_.inequalities()[static_cast<std::size_t>(j)];
    J.outerIndexPtr()[j] = entries;
    for (Index k = 0; k < f; ++k) {
      if (a[k] == 0) continue;
      J.innerIndexPtr()[entries] = static_cast<int>(k);
      J.valuePtr()[entries++] = a[k];
    }
    reduced.c[j] = a.norm() > nothing ? climb_.b[j] : -std::numeric_limits<double>::infinity();
    reduced.key[static_cast<std::size_t>(j)] =
        p.key[static_cast<std::size_t>(form_.rows().row[static_cast<std::size_t>(i)])];
  }
  J.outerIndexPtr()[m] = entries;
  J.resizeNonZeros(entries);
}

bool ReducedActiveSet::solve(const Problem& p, const SolveOptions& options, Solution& solution) {
  const Deadline deadline(options.time_limit);
  if (options.observe) return refuse("an observer");
  if (!prepare(p)) return false;

  start_.clear();
  if (options.warm_start) {
    column_.assign(static_cast<std::size_t>(form_.rows().rows()), -1);
    for (std::size_t j = 0; j < form_.inequalities().size(); ++j)
      column_[static_cast<std::size_t>(form_.inequalities()[j])] = static_cast<Index>(j);
    for (const Index i : warm_.find(p, form_.rows(), options.warm_start))
      start_.push_back(column_[static_cast<std::size_t>(i)]);
  }
  solution.iterations = 0;
  return finish(options, deadline, start_, solution);
}

bool ReducedActiveSet::finish(const SolveOptions& options, const Deadline& deadline, std::span<const Index> active,
                              Solution& solution) {
  const double allowed = std::max(10 * options.tolerance, 1e-12);
  if (!guess_holds(active, allowed)) {
    complete();
    constexpr int rounds = 8;
    for (int round = 0;; ++round) {
      const auto end = climb_.climb(solution.iterations, options.max_iterations, deadline);
      if (end != LeastDistance::End::optimal) return refuse("no clear optimum");
      if (!clearly_independent()) return refuse("nearly dependent active rows");
      begin_from_climb();
      if (!refine()) return refuse("the refinement does not contract");
      if (climb_.accept(v_, mu_)) break;
      if (round == rounds) return refuse("decisions that rounding makes");
    }
    if (!rest_holds(allowed)) return refuse("a row violated by less than rounding in double");
  }

  point_.write(form_.rows(), solution.z, solution.lambda);
  for (const Index i : form_.inequalities()) {
    double& own = solution.lambda[form_.rows().row[static_cast<std::size_t>(i)]];
    own = std::max(0.0, own);
  }
  for (Index j = 0; j < climb_.rows(); ++j)
    if (climb_.is_retired(j))
      solution.redundant.push_back(
          form_.rows().row[static_cast<std::size_t>(form_.inequalities()[static_cast<std::size_t>(j)])]);
  solution.margins = {.rank = static_cast<Index>(form_.equalities().size() + climb_.active().size()),
                      .smallest_accepted = std::min(form_.smallest_pivot(), climb_.smallest_accepted),
                      .largest_rejected = climb_.largest_rejected};
  solution.status = Status::solved;
  return true;
}

// Where the rows of a warm start are the active ones, the others need not be reduced: they are only held against the
// answer.
bool ReducedActiveSet::guess_holds(std::span<const Index> active, double allowed) {
  if (active.empty()) return false;
  if (!complete_)
    for (const Index j : active) fill(j);
  climb_.start_from(active);
  if (!clearly_independent()) return false;
  begin_from_climb();
  return !any_violated() && refine() && climb_.accept(v_, mu_) && rest_holds(allowed);
}

bool ReducedActiveSet::any_violated() const {
  const double length = y_.norm();
  for (Index j = 0; j < climb_.rows(); ++j) {
    const Index i = form_.inequalities()[static_cast<std::size_t>(j)];
    if (!climb_.is_active(j) && form_.rows().h[i] - form_.rows().dot(i, y_) >
                                    LeastDistance::violation_tolerance * (form_.rows().magnitude[i] + length))
      return true;
  }
  return false;
}

// (z, lambda) of the climb's point.
void ReducedActiveSet::begin_from_climb() {
  const BodyRows& rows = form_.rows();
  const auto q = static_cast<Index>(climb_.active().size());
  v_ = climb_.v();
  mu_ = climb_.u();
  form_.expand(v_, y_);
  y_ += form_.y_E();
  rest_ = y_;
  for (Index j = 0; j < q; ++j) rows.add(active_row(j), -mu_[j], rest_);
  form_.multipliers(rest_, mu_E_);

  point_.begin(rows, y_);
  push(mu_E_, mu_);
}

void ReducedActiveSet::push(const Vector& mu_E, const Vector& mu_I) {
  for (std::size_t k = 0; k < form_.equalities().size(); ++k)
    point_.push(form_.rows(), form_.equalities()[k], mu_E[static_cast<Index>(k)]);
  for (Index j = 0; j < static_cast<Index>(climb_.active().size()); ++j)
    point_.push(form_.rows(), active_row(j), mu_I[j]);
}

// M (z_u - z) + J'lambda, whitened, and c - J z over the rows that hold with equality.
void ReducedActiveSet::compute_residuals() {
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
double ReducedActiveSet::correct() {
  const BodyRows& rows = form_.rows();
  const auto q = static_cast<Index>(climb_.active().size());
  form_.shift(sigma_E_, step_);
  form_.reduce(rho_, s_v_);
  for (Index j = 0; j < q; ++j) sigma_I_[j] -= rows.dot(active_row(j), step_);
  climb_.solve_transposed(sigma_I_);
  climb_.project(s_v_, dv_);
  for (Index j = 0; j < q; ++j) sigma_I_[j] -= dv_[j];
  climb_.combine(sigma_I_, dv_);
  dv_ += s_v_;
  climb_.solve(sigma_I_);  // now dmu

  // Multipliers of the equality rows from what the rest leaves of dy - rho.
  form_.expand(dv_, rest_);
  step_ += rest_;
  rest_ = step_ - rho_;
  for (Index j = 0; j < q; ++j) rows.add(active_row(j), -sigma_I_[j], rest_);
  form_.multipliers(rest_, mu_E_);

  y_ += step_;
  v_ += dv_;
  mu_.head(q) += sigma_I_.head(q);
  push(mu_E_, sigma_I_);
  point_.move(rows, step_);
  return std::max(step_.norm(), rho_.norm());
}

bool ReducedActiveSet::refine() {
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
// be short of, and what that leaves open may not move z by more than `limit`, relative: the careful path's
// leaves_in_doubt().
bool ReducedActiveSet::rest_holds(double limit) {
  const BodyRows& rows = form_.rows();
  const double length = y_.norm(), far = std::max(length, rows.free_norm);
  for (Index j = 0; j < climb_.rows(); ++j) {
    if (climb_.is_active(j)) continue;
    const Index i = form_.inequalities()[static_cast<std::size_t>(j)];
    const double size = rows.magnitude[i] + length;
    if (rows.dot(i, y_) - rows.h[i] > clear_slack * size) continue;
    const double violation = point_.violation(rows, i);
    if (violation > rounding * size) return false;
    const double most = violation + fine * size;
    if (!(most > 0)) continue;
    if (!complete_) fill(j);
    if (const double share = climb_.share(j); share > clear_rejected && most > limit * far * share) return false;
  }
  return true;
}

}  // namespace zwang
