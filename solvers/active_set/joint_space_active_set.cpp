#include <zwang/solvers/active_set/joint_space_active_set.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include <zwang/core/number/double_double.h>
#include <zwang/solvers/form/bound_inside.h>

namespace zwang {
namespace {

constexpr double fine = 0x1p-63, rounding = tolerances::wide_violation * fine;
// What sums of twice the digits lose of their terms.
constexpr double twice = tolerances::wide_violation * static_cast<double>(std::numeric_limits<DoubleDouble>::epsilon());

// Has it an entry that rounding hides beside the others? It may be all that a combination of rows leaves.
bool is_faint(const BodyRows& rows, Index i) {
  const auto faint = [&](const auto& part) {
    return ((part.array() != 0) && (part.array().abs() < tolerances::faint_share * rows.row_norm[i])).any();
  };
  return faint(rows.own_part(i, 0)) || (rows.body[zwang::at(i)][1] >= 0 && faint(rows.own_part(i, 1)));
}

}  // namespace

// Pivots and remainders between these could go either way by the rounding of N.
bool JointSpaceActiveSet::clearly_independent() const {
  return climb_.smallest_accepted >= tolerances::clear_pivot && climb_.largest_rejected <= tolerances::clear_rest;
}

// Inequality row j enters the climb.
void JointSpaceActiveSet::take(Index j) {
  Index& place = place_[at(j)];
  if (place >= 0) return;
  place = climb_.rows();
  const Index i = form_.inequalities()[at(j)];
  taken_.push_back(i);
  const BodyRows& rows = form_.rows();
  form_.reduce_row(i, climb_.admit(rows.h[i] - rows.dot(i, form_.y_E()), rows.magnitude[i]));
}

// The rows that y violates and that are not in the climb enter it, the worst of them where there are many: with 200
// contacts, steps over fewer rows pay for being more (9 % of the time), with 64 they do not.
bool JointSpaceActiveSet::take_violated() {
  constexpr std::size_t most = 80, pay_for_N = 48;
  const BodyRows& rows = form_.rows();
  const double length = y_.norm();
  violated_.clear();
  for (Index j = 0; j < static_cast<Index>(place_.size()); ++j) {
    if (place_[at(j)] >= 0) continue;
    const Index i = form_.inequalities()[at(j)];
    const double slack = rows.dot(i, y_) - rows.h[i];
    if (-slack > DenseDualActiveSet::violation_tolerance * (rows.magnitude[i] + length))
      violated_.emplace_back(slack, j);
  }
  if (violated_.size() > most) {
    std::ranges::nth_element(violated_, violated_.begin() + most);
    violated_.resize(most);
  }
  if (violated_.size() >= pay_for_N) form_.form_basis();
  order_by_body();
  for (const Index j : ordered_) take(j);
  return !violated_.empty();
}

// violated_ as ordered_: neighbours meet the same unknowns, which row_lanes.h makes use of.
void JointSpaceActiveSet::order_by_body() {
  const BodyRows& rows = form_.rows();
  const auto last_body = [&](Index j) {
    const auto [first, second] = rows.body[at(form_.inequalities()[at(j)])];
    return at(std::max(first, second));
  };
  place_of_body_.assign(at(rows.bodies()) + 1, 0);
  for (const auto& [slack, j] : violated_) ++place_of_body_[last_body(j) + 1];
  std::partial_sum(place_of_body_.begin(), place_of_body_.end(), place_of_body_.begin());
  ordered_.resize(violated_.size());
  for (const auto& [slack, j] : violated_) ordered_[place_of_body_[last_body(j)]++] = j;
}

bool JointSpaceActiveSet::prepare(const Problem& p) {
  reason_ = {};
  if (const auto refused = form_.build(p); !refused.empty()) return refuse(refused);
  if (form_.smallest_pivot() < tolerances::clear_pivot) return refuse("nearly dependent joints");
  climb_.reset(form_.freedom(), static_cast<Index>(form_.inequalities().size()));
  climb_.fixed_length = form_.y_E().norm();
  place_.assign(form_.inequalities().size(), -1);
  taken_.clear();
  for (std::vector<Index>* list : {&taken_, &ordered_, &start_, &listed_}) list->reserve(place_.size());
  violated_.reserve(place_.size());
  violation_.resize(place_.size());
  const Index bodies = form_.rows().bodies(), padded = climb_.padded();
  for (Motion* part : {&y_, &step_, &rest_, &rho_}) part->resize(BodyRows::lanes, bodies);
  for (Vector* part : {&mu_E_, &sigma_E_}) part->resize(static_cast<Index>(form_.equalities().size()));
  for (Vector* part : {&mu_, &sigma_I_, &dv_, &dmu_, &s_v_, &v_}) part->setZero(padded);
  return true;
}

// A row that the joints leave nothing of is noise, which a method would take for a row: it is idle (c = -Inf), and
// finish() judges it.
void JointSpaceActiveSet::state(const Problem& p, Problem& reduced) {
  if (!place_.empty()) form_.form_basis();
  for (Index j = 0; j < static_cast<Index>(place_.size()); ++j) take(j);
  const Index f = climb_.freedom(), m = climb_.rows();
  reduced.name = p.name;
  if (reduced.M.rows() != f) {
    reduced.M.resize(f, f);
    reduced.M.setIdentity();
    reduced.z_u.setZero(f);
  }
  reduced.c.resize(m);
  reduced.kind.assign(at(m), RowKind::inequality);
  reduced.key.resize(at(m));
  auto& J = reduced.J;
  if (J.rows() != m || J.cols() != f) J.resize(m, f);
  J.resizeNonZeros(m * f);
  int entries = 0;
  for (Index j = 0; j < m; ++j) {
    const auto a = climb_.row(j).head(f);
    const Index i = form_.inequalities()[at(j)];
    J.outerIndexPtr()[j] = entries;
    for (Index k = 0; k < f; ++k) {
      if (a[k] == 0) continue;
      J.innerIndexPtr()[entries] = static_cast<int>(k);
      J.valuePtr()[entries++] = a[k];
    }
    reduced.c[j] = a.norm() > tolerances::reduced_to_nothing ? climb_.b(j) : -infinity;
    reduced.key[at(j)] = p.key[at(form_.rows().row[at(i)])];
  }
  J.outerIndexPtr()[m] = entries;
  J.resizeNonZeros(entries);
}

bool JointSpaceActiveSet::solve(const Problem& p, const SolveOptions& options, Solution& solution) {
  const Deadline deadline(options.time_limit);
  if (options.observe) return refuse("an observer");
  if (!prepare(p)) return false;

  start_.clear();
  if (options.warm_start) {
    column_.assign(at(form_.rows().rows()), -1);
    for (std::size_t j = 0; j < form_.inequalities().size(); ++j)
      column_[at(form_.inequalities()[j])] = static_cast<Index>(j);
    for (const Index i : warm_.find(p, form_.rows(), options.warm_start)) start_.push_back(column_[at(i)]);
  }
  solution.iterations = 0;
  return finish(options, deadline, start_, solution);
}

// Rows enter the climb when its optimum violates them; the others are only held against the answer. A warm start whose
// rows are the active ones climbs nothing. Without joints rows cost nothing to reduce, and all enter at once where they
// are not many: of those that came in parts, many left again (walls, stacks).
bool JointSpaceActiveSet::climb(const SolveOptions& options, const Deadline& deadline, std::span<const Index> active,
                                int& iterations) {
  start_.clear();
  const Index rows = static_cast<Index>(place_.size()), many = 2 * form_.freedom();
  for (Index j = 0; j < rows && rows < many && form_.equalities().empty(); ++j) take(j);
  for (const Index j : active) {
    take(j);
    start_.push_back(place_[at(j)]);
  }
  climb_.start_from(start_);
  return settle(options, deadline, iterations);
}

bool JointSpaceActiveSet::finish(const SolveOptions& options, const Deadline& deadline, std::span<const Index> active,
                                 Solution& solution) {
  if (!climb(options, deadline, active, solution.iterations)) return false;
  const double limit = accepted_error(options.tolerance);
  constexpr int rounds = 8;
  for (int round = 0;; ++round) {
    begin_from_climb();
    if (!polish) {
      own_y_ = y_;
      point_.write(form_.rows(), solution.z, solution.lambda);
    }
    if (!refine()) return refuse("the refinement does not contract");
    if (climb_.has_climbed()) form_.reduce(y_, v_);
    if (climb_.accept(v_, mu_)) {
      if (rest_holds(limit)) break;
      if (!take_violated() && !enter_short()) return refuse("a row violated by less than rounding in double");
    }
    if (round == rounds) return refuse("decisions that rounding makes");
    if (!settle(options, deadline, solution.iterations)) return false;
  }

  if (polish) {
    point_.write(form_.rows(), solution.z, solution.lambda);
  } else {
    own_y_ -= y_;
    last_change_ += own_y_.norm();
    if (!(own_y_.norm() <= limit * std::max(y_.norm(), form_.rows().free_norm))) return refuse("an inaccurate answer");
  }
  if (options.has_accuracy()) solution.error_bound = error_bound();
  for (const Index i : form_.inequalities()) {
    double& own = solution.lambda[form_.rows().row[at(i)]];
    own = std::max(0.0, own);
  }
  for (Index k = 0; k < climb_.rows(); ++k)
    if (climb_.is_retired(k)) solution.redundant.push_back(form_.rows().row[at(taken_[at(k)])]);
  solution.margins = {.rank = static_cast<Index>(form_.equalities().size() + climb_.active().size()),
                      .smallest_accepted = std::min(form_.smallest_pivot(), climb_.smallest_accepted),
                      .largest_rejected = climb_.largest_rejected};
  solution.status = Status::solved;
  return true;
}

// Climbs until no row is violated.
bool JointSpaceActiveSet::settle(const SolveOptions& options, const Deadline& deadline, int& iterations) {
  do {
    const bool all_active = climb_.rows() == static_cast<Index>(climb_.active().size());
    if (!all_active && climb_.climb(iterations, options.max_iterations, deadline) != Status::solved)
      return refuse("no clear optimum");
    if (!clearly_independent()) return refuse("nearly dependent active rows");
    locate();
  } while (take_violated());
  return true;
}

// y of the climb's point.
void JointSpaceActiveSet::locate() {
  y_ = form_.y_E();
  if (climb_.active().empty()) return;
  form_.expand(climb_.v(), rest_);
  y_ += rest_;
}

// (z, lambda) of the climb's point; the rows listed are the active ones until the refinement has ended.
void JointSpaceActiveSet::begin_from_climb() {
  const BodyRows& rows = form_.rows();
  mu_ = climb_.u();
  rest_ = y_;
  listed_.clear();
  for (Index k = 0; k < static_cast<Index>(climb_.active().size()); ++k) {
    listed_.push_back(active_row(k));
    rows.add(listed_.back(), -mu_[k], rest_);
  }
  form_.multipliers(rest_, mu_E_);
  point_.begin(rows, y_);
  push(mu_E_, mu_);
}

void JointSpaceActiveSet::push(const Vector& mu_E, const Vector& mu_I) {
  point_.push(form_.rows(), form_.equalities(), mu_E.data());
  point_.push(form_.rows(), listed_, mu_I.data());
}

// M (z_u - z) + J'lambda, whitened, and c - J z over the rows that hold with equality.
void JointSpaceActiveSet::compute_residuals() {
  const BodyRows& rows = form_.rows();
  point_.begin_force(rows);
  point_.add_rows(rows, form_.equalities(), sigma_E_.data());
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
  climb_.solve(s_v_, sigma_I_, dv_, dmu_);

  // Multipliers of the equality rows from what the rest leaves of dy - rho.
  form_.expand(dv_, rest_);
  step_ += rest_;
  rest_ = step_ - rho_;
  for (Index j = 0; j < q; ++j) rows.add(active_row(j), -dmu_[j], rest_);
  form_.multipliers(rest_, mu_E_);

  y_ += step_;
  mu_.head(q) += dmu_.head(q);
  push(mu_E_, dmu_);
  point_.move(rows, step_);
  return std::max(step_.norm(), rho_.norm());
}

bool JointSpaceActiveSet::refine() {
  constexpr int passes = 4;
  for (int pass = 0; pass < passes; ++pass) {
    compute_residuals();
    const double change = last_change_ = correct();
    const double size = y_.norm() + form_.rows().free_norm;
    // The next correction would be about change^2 / size.
    if (change * change <= std::numeric_limits<double>::epsilon() * tolerances::refined * size * size) return true;
  }
  return false;
}

// What the refinement leaves of a row that it meets, and sums of twice the digits lose.
double JointSpaceActiveSet::left(Index i, double far) const {
  return last_change_ * last_change_ / far + twice * point_.terms(form_.rows(), i);
}

// The rows outside the active set, from the problem's own J and c: rounding in an answer of 64 bits is all they may
// be short of, and what that leaves open, until another row gives way, may not move z by more than `limit`, relative:
// the careful path's doubt_others(). A row that the joints and active rows determine has to hold by itself. Of two
// that touch no bound is had: a point that meets one may be far from the other, and is where they are all but opposed;
// and the active row that would give way to one may be held by the other.
bool JointSpaceActiveSet::rest_holds(double limit) {
  const BodyRows& rows = form_.rows();
  const double length = y_.norm(), far = std::max(length, rows.free_norm), touch = DenseDualActiveSet::epsilon * far;
  Index gives_way = -1;  // a row outside: were it obeyed, an active one would
  listed_.clear();
  ordered_.clear();
  for (Index j = 0; j < static_cast<Index>(place_.size()); ++j) {
    if (is_active(j)) continue;
    const Index i = form_.inequalities()[at(j)];
    const double clear = tolerances::clear_slack * (rows.magnitude[i] + length);
    if (rows.dot(i, y_) - rows.h[i] > std::max(clear, 2 * tolerances::loosest_bound * far)) continue;
    listed_.push_back(i);
    ordered_.push_back(j);
  }
  point_.violations(rows, listed_, violation_.data());
  doubt_ = 0;
  short_ = -1;
  Index touching = 0;
  for (Index k = 0; k < std::ssize(ordered_); ++k) {
    const Index i = listed_[at(k)], j = ordered_[at(k)];
    const double size = rows.magnitude[i] + length, violation = violation_[at(k)];
    if (violation > rounding * size) return falls_short(j);
    const double most = violation + fine * size;
    if (most > -touch) {
      std::swap(listed_[at(touching)], listed_[at(k)]);
      std::swap(violation_[at(touching++)], violation_[at(k)]);
    }
    if (!(most > 0)) continue;
    take(j);
    const double share = climb_.share(place_[at(j)]), allowed = limit * far;
    const double moves = most / share;
    doubt_ += share > tolerances::exact_share && moves <= touch ? moves : infinity;
    if (moves <= allowed) continue;
    if (climb_.detour(share, most) <= allowed)
      gives_way = violation > left(i, far) ? j : gives_way;
    else if (share <= tolerances::exact_share && is_faint(rows, i))
      return false;
    else if (share > tolerances::exact_share || violation > std::min(left(i, far), rounding * point_.terms(rows, i)))
      return falls_short(j);
  }
  if (gives_way >= 0 && touching > 1) return falls_short(gives_way);
  if (touching > 1) doubt_ = infinity;
  for (Index t = 0; t < touching; ++t) {
    if (!(violation_[at(t)] > left(listed_[at(t)], far)) && !is_faint(rows, listed_[at(t)])) continue;
    rest_.setZero();
    rows.add(listed_[at(t)], 1, rest_);
    for (const Index k : std::span(listed_).first(at(touching)))
      if (rows.dot(k, rest_) < tolerances::clear_pivot - 1) return false;
  }
  return true;
}

// The row that rest_holds() stopped at becomes active, though double does not see that it is violated (a hand that
// touches, and is all but at rest): the refinement then says with which force. False where the climb cannot.
bool JointSpaceActiveSet::enter_short() {
  if (short_ < 0) return false;
  take(short_);
  return climb_.obey(place_[at(short_)]);
}

// In exact arithmetic the last correction ends at the answer. It is counted twice for what the factors' rounding leaves
// of it; multipliers that pull, and are cut off, move y by no more than they are.
double JointSpaceActiveSet::error_bound() {
  const auto mu = mu_.head(static_cast<Index>(climb_.active().size()));
  const double length = y_.norm(), free = form_.rows().free_norm;
  const double most = 2 * last_change_ - mu.cwiseMin(0).sum() + fine * form_.rows().tied() * (length + free);
  return relative_bound(doubt_ < infinity ? most + doubt_ : inside(most), length, free);
}

// Where more rows touch: at a point that meets all, from what the forces are `unbalanced`. Beside joints none is looked
// for. Near rows outside the active set are those that rest_holds() listed.
double JointSpaceActiveSet::inside(double unbalanced) {
  const BodyRows& rows = form_.rows();
  const auto q = static_cast<Index>(climb_.active().size());
  constexpr double epsilon = DenseDualActiveSet::epsilon, loose = tolerances::wide_violation * epsilon;
  const double far = std::max(y_.norm(), rows.free_norm);
  if (!form_.equalities().empty()) return infinity;
  s_v_.setZero();
  sigma_I_.head(q).setOnes();
  climb_.solve(s_v_, sigma_I_, dv_, dmu_);
  form_.expand(dv_, step_);
  near_.clear();
  near_.reserve(listed_.size() + at(q));
  // As left(), with the length of z in place of its terms.
  const double size = 6 * std::sqrt(rows.tied()) * ((rows.free + y_).norm() + epsilon * far),
               hidden = last_change_ * last_change_ / far + twice * size;
  const auto list = [&](Index i, double violation, double push) {
    const double own = hidden + twice * std::abs(std::ldexp(rows.c[i] / rows.row_norm[i], -rows.exponent));
    near_.push_back({i, violation + own, own - violation, push});
  };
  ordered_.clear();
  for (Index k = 0; k < q; ++k) ordered_.push_back(active_row(k));
  point_.violations(rows, ordered_, dmu_.data());
  for (Index k = 0; k < q; ++k) list(ordered_[at(k)], dmu_[k], mu_[k]);
  for (std::size_t k = 0; k < listed_.size(); ++k) list(listed_[k], violation_[k], 0);
  open_all(rows, near_, epsilon * far, step_);
  const double bound = bound_inside(near_, step_.norm(), unbalanced, loose);
  return bound <= tolerances::loosest_bound * far ? bound : infinity;
}

}  // namespace zwang
