#include <zwang/solvers/newton/newton_polish.h>

#include <algorithm>
#include <cmath>

#include <zwang/solvers/form/bound_inside.h>

namespace zwang {
namespace {

constexpr int most_passes = 40, most_let_go = 30, most_share_passes = 12;
constexpr long double real_eps = std::numeric_limits<long double>::epsilon();

}  // namespace

bool NewtonPolish::run(AugmentedLagrangian& L, double tolerance, const Deadline& deadline, Solution& s) {
  const Index k = L.rows.rows();
  d_ = L.d.cast<Real>();
  l_ = L.l.cast<Real>();
  doubtful = false;
  const bool stops = enough > 0 && L.unknowns() > tolerances::few_unknowns;
  if (stops) open(L, false);
  for (Index i = 0; i < k; ++i) L.weight[i] = L.is_equality(i) || L.l[i] > 0 ? L.s : 0;
  double last = infinity, length = infinity;
  bool changed = true, stronger = false;
  int let_go_of = 0;
  for (int pass = 0; pass < most_passes; ++pass) {
    if (deadline.passed()) return false;
    L.residuals(d_, l_, force_, violation_);
    const bool settled = !changed;
    double worst = 0;
    for (Index i = 0; i < k; ++i)
      if (L.weight[i] != 0)
        worst = std::max(worst, static_cast<double>(std::abs(violation_[i])) / (L.rows.magnitude[i] + L.scale));
    changed = exchange(L, worst);
    const bool reached = stops && bound(L) <= enough;
    const bool stays = !changed && settled && length <= tolerances::newton_polished * L.scale;
    const bool agrees = worst <= tolerances::violation * static_cast<double>(real_eps);
    if (stays && !agrees && alone && let_go_of < most_let_go && let_go(L)) {
      ++let_go_of;
      changed = true;
      pass = 0;
    }
    if (reached || (stays && agrees)) {
      doubtful = !alone && !reached && is_doubtful(L);
      if (doubtful) return false;
      L.write(d_, l_, s);
      s.redundant.assign(L.rows.idle.begin(), L.rows.idle.end());
      const double mu = (1 / std::clamp(L.rate, tolerances::newton_least_rate, 1.0) - 1) / L.s;
      const double error = length + worst * L.scale / std::sqrt(std::max(mu, tolerances::newton_least_eigenvalue));
      const bool sure = reached || (let_go_of == 0 && error <= accepted_error(tolerance) * L.scale);
      if (stops ? bound_ < infinity : !alone && bound_ <= enough)
        s.error_bound = bound_ / L.rows.free_norm;
      else if (asks)
        s.error_bound = bound_at(L);
      s.status = sure ? Status::solved : Status::solved_ill_conditioned;
      return true;
    }
    if ((changed || pass == 0 || stronger) && !L.factorize(deadline)) return false;
    if (changed || stronger) ++s.iterations;
    stronger = false;
    last = length;
    length = step(L);
    if (!std::isfinite(length)) return false;
    if (changed || !(last < infinity && last > tolerances::newton_telling * L.scale)) continue;
    L.rate = length / last;
    stronger = alone && L.rate > tolerances::newton_slow && strengthen(L);
  }
  return false;
}

// Rows leave and enter. Has any? `worst`: violation of a row that is in, of its size. A row out that is violated by no
// more says nothing yet: with 10,000 bricks such rows came and went for eight factorizations.
bool NewtonPolish::exchange(AugmentedLagrangian& L, double worst) {
  const Real least = std::max(Real(worst), tolerances::wide_violation * real_eps);
  bool changed = false;
  for (Index i = 0; i < L.rows.rows(); ++i) {
    if (L.is_equality(i)) continue;
    const double size = L.rows.magnitude[i] + L.scale;
    const bool was_active = L.weight[i] != 0;
    const bool is_active = was_active ? !(l_[i] < -Real(tolerances::pull) * L.scale) : violation_[i] > least * size;
    changed = changed || is_active != was_active;
    L.weight[i] = is_active ? L.s : 0;
    if (is_active || l_[i] == 0) continue;
    L.add(i, Real(-l_[i]), force_);
    l_[i] = 0;
  }
  return changed;
}

// Where rows that repeat each other do not agree to the last digit no d meets them all. Each step of l then adds the
// violations that no d can mend, which move no body; the row whose force they bring to zero first lets go.
bool NewtonPolish::let_go(AugmentedLagrangian& L) {
  Index first = -1;
  Real longest = std::numeric_limits<Real>::infinity();
  for (Index i = 0; i < L.rows.rows(); ++i) {
    if (L.weight[i] == 0 || L.is_equality(i) || !(violation_[i] < 0)) continue;
    const Real way = l_[i] / -violation_[i];
    if (way < longest) longest = way, first = i;
  }
  if (first < 0) return false;
  for (Index i = 0; i < L.rows.rows(); ++i)
    if (L.weight[i] != 0) l_[i] += longest * violation_[i];
  L.weight[first] = 0;
  L.add(first, Real(-l_[first]), force_);
  l_[first] = 0;
  return true;
}

// Rows that all but repeat each other converge slowly under a small penalty.
bool NewtonPolish::strengthen(AugmentedLagrangian& L) {
  constexpr double more = 100;
  const double before = L.s;
  L.s = std::min(more * before, tolerances::newton_largest_penalty);
  if (L.s == before) return false;
  for (Index i = 0; i < L.rows.rows(); ++i)
    if (L.weight[i] != 0) L.weight[i] = L.s;
  L.rate = 1 / (1 + L.s / before * (1 / std::min(L.rate, 1.0) - 1));
  return true;
}

// One step of (d, l) on the rows that have weight. Returns the length of that of d.
double NewtonPolish::step(AugmentedLagrangian& L) {
  step_ = force_.cast<double>();
  for (Index i = 0; i < L.rows.rows(); ++i)
    if (L.weight[i] != 0) L.add(i, L.s * static_cast<double>(violation_[i]), step_);
  L.solve(step_);
  d_ += step_.cast<Real>();
  for (Index i = 0; i < L.rows.rows(); ++i)
    if (L.weight[i] != 0) l_[i] += Real(L.s) * (violation_[i] - Real(L.dot(i, step_)));
  return L.mass_norm(step_);
}

// A motion that is to open the rows that are held by 1, or to move the equality rows by parts of 1 that differ.
void NewtonPolish::open(AugmentedLagrangian& L, bool equality, double turn) {
  missed_.setZero(L.rows.rows());
  step_.setZero(L.unknowns());
  for (Index i = 0; i < missed_.size(); ++i) {
    if (L.weight[i] == 0 || L.is_equality(i) != equality) continue;
    missed_[i] = equality ? std::sin(static_cast<double>(i + 1) + turn) : 1;
    L.add(i, L.weight[i] * static_cast<double>(missed_[i]), step_);
  }
  L.solve(step_);
  open_.resize(missed_.size());
  for (Index i = 0; i < open_.size(); ++i) {
    open_[i] = L.dot(i, step_);
    if (missed_[i] != 0) missed_[i] -= open_[i];
  }
  open_length_ = L.mass_norm(step_);
}

// |d - d*|_M at most, d* the answer, by the duality of Promise along open_. Infinite where that does not open rows, or
// not without moving equality rows; beside these it is no bound.
double NewtonPolish::bound(AugmentedLagrangian& L) {
  constexpr double eps = std::numeric_limits<double>::epsilon(), still = tolerances::newton_unmoved;
  near_.clear();
  step_ = force_.cast<double>();
  for (Index i = 0; i < open_.size(); ++i) {
    const double violation = static_cast<double>(violation_[i]), push = static_cast<double>(l_[i]), opens = open_[i];
    if (L.is_equality(i) && std::abs(opens) > still) near_.push_back({i, 0, 0, 0, -1});
    if (L.is_equality(i)) continue;
    const auto rounding = static_cast<double>(real_eps) * (L.rows.magnitude[i] + L.scale);
    const double most = violation + tolerances::wide_violation * rounding;
    near_.push_back({i, most, std::abs(violation), push, most > 0 && !(opens > still) ? std::min(opens, 0.0) : opens});
    if (push < 0) L.add(i, -push, step_);
  }
  return bound_ = bound_inside(near_, open_length_, L.force_norm(step_)) +
                  (tolerances::rank * eps + tolerances::violation * real_eps * L.rows.factor.tied()) * L.scale;
}

// The error of d where the rows that are held are clearly independent and no other is touched: a point that meets all
// is near.
double NewtonPolish::bound_at(AugmentedLagrangian& L) {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  double open = infinity, missed = 0;
  step_ = d_.cast<double>();
  const double length = L.mass_norm(step_);
  step_ = force_.cast<double>();
  unit_.setZero(L.rows.rows());
  for (Index i = 0; i < unit_.size(); ++i) {
    const double violation = static_cast<double>(violation_[i]), push = static_cast<double>(l_[i]);
    const auto rounding = static_cast<double>(real_eps) * (L.rows.magnitude[i] + L.scale);
    if (L.weight[i] == 0)
      open = std::min(open, -violation);
    else
      missed = std::max(missed, std::abs(violation) + tolerances::wide_violation * rounding);
    unit_[i] = L.weight[i] == 0 ? 0 : 1 + std::sin(static_cast<double>(i + 1)) / 2;
    if (!L.is_equality(i) && push < 0) L.add(i, -push, step_);
  }
  if (!(open > tolerances::promise_touching * L.scale)) return std::numeric_limits<double>::quiet_NaN();
  const double unbalanced = L.force_norm(step_);
  const double share = least_share(unit_, 1 / L.s, most_share_passes, [&] {
    step_.setZero();
    for (Index i = 0; i < unit_.size(); ++i)
      if (unit_[i] != 0) L.add(i, L.s * unit_[i], step_);
    L.solve(step_);
    for (Index i = 0; i < unit_.size(); ++i)
      if (L.weight[i] != 0) unit_[i] -= L.dot(i, step_);
  });
  const double across = missed / share,
               most = unbalanced + 2 * across +
                      (tolerances::rank * eps + tolerances::violation * real_eps * L.rows.factor.tied()) * L.scale;
  return across < open ? relative_bound(most, length, L.rows.free_norm) : std::numeric_limits<double>::quiet_NaN();
}

// Where rows nearly depend on each other, a violation that the widest scalar hides may be worth any motion, and the
// rate of convergence does not tell: it is below rounding from the start. A motion that cannot open the rows, or move
// equality rows at will, does tell; of equality rows that depend exactly, which do no harm, the combination that is
// zero is found then. Entries left out of its rows (faint) may be all it leaves. At one turn the parts may happen to
// suit rows that face others.
bool NewtonPolish::is_doubtful(AugmentedLagrangian& L) {
  open(L, false);
  if (!(bound(L) <= tolerances::newton_doubt * L.scale)) return true;
  if (std::ranges::count(L.rows.equality, 1) == 0) return false;
  const auto is_there = [&] { return missed_.lpNorm<Eigen::Infinity>() > tolerances::newton_unmoved; };
  const auto combines = [&](const UnitRows::Faint& e) {
    return std::abs(missed_[std::ranges::lower_bound(L.rows.row, e.row) - L.rows.row.begin()]) >
           tolerances::newton_unmoved;
  };
  for (const double turn : {0.0, 2.0}) {
    open(L, true, turn);
    if (is_there()) contract(L, missed_);
    if (!is_there()) continue;
    step_ = force_.cast<double>();
    if (std::ranges::any_of(L.rows.faint, combines) ||
        L.force_norm(step_) > static_cast<double>(tolerances::rank * real_eps) ||
        std::abs(missed_.dot(violation_)) > real_eps * missed_.cwiseAbs().dot(violation_.cwiseAbs()))
      return true;
  }
  return false;
}

// What of u moves bodies is taken out of it; then force_ = G'u, violation_ = h.
void NewtonPolish::contract(AugmentedLagrangian& L, RealVector& u) {
  constexpr int passes = 12;
  nothing_.setZero(L.unknowns());
  for (int pass = 0;; ++pass) {
    L.residuals(nothing_, u, force_, violation_);
    if (pass == passes) return;
    step_ = force_.cast<double>();
    L.solve(step_);
    for (Index i = 0; i < u.size(); ++i)
      if (L.weight[i] != 0) u[i] -= Real(L.s) * Real(L.dot(i, step_));
  }
}

bool NewtonPolish::judge(AugmentedLagrangian& L, double tolerance, const Deadline& deadline, Solution& s) {
  const int steps = s.iterations;
  const bool settles = run(L, tolerance, deadline, s);
  s.iterations = steps;
  step_ = (d_ - L.d.cast<Real>()).cast<double>();
  if (!settles || !(L.mass_norm(step_) <= accepted_error(tolerance) * L.scale)) return false;
  L.write(L.d, L.l, s);
  return true;
}

bool NewtonPolish::certify(AugmentedLagrangian& L, const Problem& p, const Deadline& deadline, Solution& s) {
  l_.setZero(L.rows.rows());
  for (Index i = 0; i < l_.size(); ++i)
    l_[i] = L.is_equality(i) ? L.violation(i) : L.weight[i] != 0 ? std::max(0.0, L.violation(i)) : 0;
  return certify_rows(L, p, deadline, s);
}

bool NewtonPolish::certify_again(AugmentedLagrangian& L, const Problem& p, const Deadline& deadline, Solution& s) {
  l_.setZero(L.rows.rows());
  for (Index i = 0; i < l_.size(); ++i) l_[i] = Real(s.certificate[L.rows.row[at(i)]]) * Real(L.rows.row_norm[i]);
  return certify_rows(L, p, deadline, s);
}

bool NewtonPolish::certify_rows(AugmentedLagrangian& L, const Problem& p, const Deadline& deadline, Solution& s) {
  const Real least = Real(tolerances::newton_part) * l_.lpNorm<Eigen::Infinity>();
  for (Index i = 0; i < l_.size(); ++i) {
    if (std::abs(l_[i]) <= least) l_[i] = 0;
    L.weight[i] = l_[i] != 0 ? L.s : 0;
  }
  if (!L.factorize(deadline)) return false;
  contract(L, l_);
  unit_ = l_.cast<double>();
  return proof_.certify(p, L.rows, unit_, s);
}

}  // namespace zwang
