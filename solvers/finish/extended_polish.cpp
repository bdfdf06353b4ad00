#include <zwang/solvers/finish/extended_polish.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <zwang/solvers/form/bound_inside.h>

namespace zwang {

template <class Real>
const typename ExtendedPolish<Real>::Rest& ExtendedPolish<Real>::rest(Index i) {
  using std::abs, std::ldexp;
  Rest& own = rest_[at(i)];
  if (own.at_z == z_number_) return own;
  const Index row = w_->row[at(i)];
  Real violation(p_->c[row]), terms = abs(violation);
  for (RowMatrix::InnerIterator it(p_->J, row); it; ++it) {
    const Real term = Real(it.value()) * z_[it.col()];
    violation -= term;
    terms += abs(term);
  }
  const Real unit(w_->row_norm[i]);
  return own = {ldexp(Real(violation / unit), -w_->exponent), ldexp(Real(terms / unit), -w_->exponent), z_number_};
}

template <class Real>
void ExtendedPolish<Real>::prepare(const Problem& p, const Whitened& w) {
  p_ = &p;
  w_ = &w;
  const Index n = p.size(), k = w.rows();
  z_ = p.z_u.template cast<Real>();
  l_.setZero(k);
  b_.resize(k);
  force_.resize(n);
  r1_.resize(n);
  r2_.resize(std::min(n, k));
  state_.assign(at(k), State::outside);
  rest_.assign(at(k), Rest{});
  z_number_ = 0;
  share_.resize(at(k));
  touching_.reserve(at(k));
  has_faint_ = false;
  for (Index i = 0; i < k; ++i) {
    b_[i] = violation(i);
    for (RowMatrix::InnerIterator it(p.J, w.row[at(i)]); it; ++it)
      has_faint_ = has_faint_ || (it.value() != 0 && std::abs(it.value()) < tolerances::faint_share * w.row_norm[i]);
  }
  z_u_length_ = w.free_norm;
}

// What the residuals at (z_, l_) ask for: of y in r1_, of the multipliers in r2_. Returns its length: that of y, or of
// the forces that the multipliers leave unbalanced. (Looking at z alone took a dependent row with a pivot of 1.5e-14
// and a multiplier of 4e17 for solved.) M (z - z_u) comes first: where masses couple unknowns, its large terms cancel
// before the rows' small forces could lose their digits to them.
template <class Real>
double ExtendedPolish<Real>::correction(ActiveRows& active) {
  using std::ldexp;
  const Index n = p_->size(), a = active.size();
  auto r2 = r2_.head(a);
  force_.setZero();
  const Real unit = ldexp(Real(1), -w_->exponent);
  for (Index j = 0; j < n; ++j) {
    const Real d = (z_[j] - Real(p_->z_u[j])) * unit;
    for (SparseMatrix::InnerIterator it(p_->M, j); it; ++it) force_[it.row()] -= Real(it.value()) * d;
  }
  for (const Index i : active.rows()) add_row(i, l_[i], force_);
  r1_ = force_.template cast<double>();
  if (n > 0) w_->factor.solve_lower(r1_);
  for (Index i = 0; i < a; ++i) r2[i] = static_cast<double>(violation(active[i]));
  const double unbalanced = r1_.norm();
  active.correct(r1_, r2);
  return std::max(r1_.norm(), unbalanced);
}

// False when the corrections do not shrink: the factors no longer describe the rows. What stands along the smallest
// pivot shrinks by `rate` a pass, which larger corrections hide: two of them alone once foretold an end ten digits
// away. Corrections that stay alike, and are no rounding, foretell many: a row is no clear one, as doubles took it for.
template <class Real>
bool ExtendedPolish<Real>::refine(ActiveRows& active) {
  using std::ldexp, std::sqrt;
  double last = std::numeric_limits<double>::infinity();
  constexpr int most_steps = 60;
  const double rate = active.contraction();
  for (int step = 0; step < most_steps; ++step) {
    const double length = correction(active);
    for (Index i = 0; i < active.size(); ++i) l_[active[i]] += Real(r2_[i]) / Real(w_->row_norm[active[i]]);
    if (p_->size() > 0) w_->factor.solve_upper(r1_);
    const Real one = ldexp(Real(1), w_->exponent);
    for (Index j = 0; j < p_->size(); ++j) z_[j] += Real(r1_[j]) * one;
    ++z_number_;
    Real square = 0;
    for (const Index i : active.rows()) square += unit(i) * b_[i];  // |y|^2 = l'b at the solution
    length_ = static_cast<double>(sqrt(std::max(square, Real(0))));
    scale_ = std::max(z_u_length_, length_);
    if (!std::isfinite(length)) return false;
    error_ = step > 0 ? length * std::min(1.0, std::max(length / last, rate)) : length;  // the next correction
    if (error_ <= tolerances::extended_change * real_eps * scale_) return true;
    const bool alike = step > 1 && length > tolerances::no_contraction * last;
    if (alike && length > doubt_active(active)) error_ = length < last ? length / (1 - length / last) : scale_;
    if (alike) return length <= tolerances::stalled * scale_;
    last = length;
  }
  return true;
}

// The active row with the most negative multiplier, or active.size().
template <class Real>
Index ExtendedPolish<Real>::pulling_row(const ActiveRows& active) const {
  Index leaving = active.size();
  Real most = -tolerances::pull * scale_;
  for (Index i = 0; i < active.size(); ++i)
    if (!w_->equality[at(active[i])] && unit(active[i]) < most) {
      most = unit(active[i]);
      leaving = i;
    }
  return leaving;
}

// The most violated row outside, or -1, and how much: its share of its terms, of which less than `worst` is rounding.
template <class Real>
Index ExtendedPolish<Real>::violated_row(Real& worst) {
  using std::abs;
  Index entering = -1;
  for (Index i = 0; i < w_->rows(); ++i) {
    if (state_[at(i)] != State::outside) continue;
    const Real v = violation(i), size = Real(w_->magnitude[i]) + length_;
    const Real relative = (w_->equality[at(i)] ? abs(v) : v) / size;
    if (relative > worst) {
      worst = relative;
      entering = i;
    }
  }
  return entering;
}

// g_row = G_A' mu + rest as double sees it, of together() rows at most.
template <class Real>
void ExtendedPolish<Real>::express(ActiveRows& active, std::span<const Index> rows) {
  const Index a = active.size(), count = std::ssize(rows), most = active.together();
  if (V_.rows() != r1_.size() || V_.cols() < count) V_.resize(r1_.size(), most);
  if (T_.rows() < a || T_.cols() < count) T_.resize(r2_.size(), most), mu_.resize(r2_.size(), most);
  if (rest_of_.size() < count) rest_of_.resize(most), last_.resize(most);
  V_.leftCols(count).setZero();
  for (Index c = 0; c < count; ++c) active.add(rows[at(c)], 1, V_.col(c));
  active.combine(V_.leftCols(count), T_.topLeftCorner(a, count));
  mu_.topLeftCorner(a, count) = T_.topLeftCorner(a, count).template cast<Real>();
  for (Index c = 0; c < count; ++c) {
    rest_of_[c] = V_.col(c).norm();
    last_[c] = T_.col(c).head(a).norm();
  }
}

// The same in Real, from what double saw, of those that are open_. Ends when the next correction would be nothing to
// mu: among rows of small integers, corrections would otherwise shrink down to 1e-100.
template <class Real>
void ExtendedPolish<Real>::express_again(ActiveRows& active, std::span<const Index> rows) {
  const Index a = active.size();
  for (int step = 1; !open_.empty(); ++step) {
    const Index count = std::ssize(open_);
    for (Index k = 0; k < count; ++k) {
      const Index c = open_[at(k)], row = rows[at(c)];
      force_.setZero();
      add_row(row, Real(1) / Real(w_->row_norm[row]), force_);
      for (Index i = 0; i < a; ++i) add_row(active[i], -mu_(i, c) / Real(w_->row_norm[active[i]]), force_);
      r1_ = force_.template cast<double>();
      w_->factor.solve_lower(r1_);
      V_.col(k) = r1_;
    }
    active.combine(V_.leftCols(count), T_.topLeftCorner(a, count));
    std::size_t left = 0;
    for (Index k = 0; k < count; ++k) {
      const Index c = open_[at(k)];
      auto mu = mu_.col(c).head(a);
      mu += T_.col(k).head(a).template cast<Real>();
      const double change = T_.col(k).head(a).norm(), last = std::exchange(last_[c], change);
      const double weight = 1 + mu.template cast<double>().template lpNorm<1>();
      const double next = change < last ? change * (change / last) : change;
      rest_of_[c] = V_.col(k).norm();
      if (!(next <= real_eps * weight || (step > 2 && !(change < last / 2)))) open_[left++] = c;
    }
    open_.resize(left);
  }
}

// Whether certificate_ proves that there is no z: h'u / |G'u| is beyond any motion of this problem, by the referee's
// bound. |G'u| beyond row_rounding of sum |u_i| is no rounding of the rows: a long motion may then meet them. A wedge
// with an opening of 2^-46 and z_u = 0 has no length but that opening: its only motion, of length 1, is 2^46 times as
// long, and the referee's bound alone would call it contradicting. Nor does |G'u| see what heavy unknowns ask for: rows
// 2^-39 from a combination may meet along one of them, so each entry of J'u has to be rounding of the rows' own ones.
template <class Real>
bool ExtendedPolish<Real>::proves(Solution& s) {
  using std::abs;
  constexpr double row_rounding = tolerances::violation * std::numeric_limits<double>::epsilon();
  Real work = 0, noise = 0, weight = 0, entries = 0;
  double reach = z_u_length_;
  force_.setZero();
  for (Index i = 0; i < w_->rows(); ++i) {
    if (certificate_[w_->row[at(i)]] == 0) continue;
    const Real u = Real(certificate_[w_->row[at(i)]]) * Real(w_->row_norm[i]);
    work += u * b_[i];
    noise += abs(u) * Real(w_->magnitude[i]);
    weight += abs(u);
    reach = std::max(reach, std::abs(w_->h[i]));
    add_row(i, Real(certificate_[w_->row[at(i)]]), force_);
    entries += abs(Real(certificate_[w_->row[at(i)]])) * Real(largest_entry(p_->J, w_->row[at(i)]));
  }
  constexpr double entry_rounding = tolerances::entry_rounding * std::numeric_limits<double>::epsilon();
  if (!(force_.cwiseAbs().maxCoeff() <= Real(entry_rounding) * entries)) return false;
  r1_ = (force_ / noise).template cast<double>();
  w_->factor.solve_lower(r1_);
  const double parts = static_cast<double>(weight / noise);
  const double rest = r1_.norm() + real_eps * parts;  // and what rounding in Real hides
  const bool proven = r1_.norm() <= row_rounding * parts && work > tolerances::violation * real_eps * noise &&
                      static_cast<double>(work / noise) >= tolerances::out_of_reach * reach * rest;
  if (!proven) return false;
  s.zero_certificate(p_->rows()) = certificate_;
  s.status = Status::infeasible;
  return true;
}

// A violated row that depends on the active ones, and its combination mu_ of them, as a proof, u = +-(e_row - mu).
// Joints that a weld repeats agree to the rounding of their poses only; the contacts then have a part of 1e-17 in the
// combination, of either sign. What has the wrong sign and cannot leave in exchange() is cut off. The proof is judged
// after rounding to double, so of three normalizations the one that rounds best is kept (rows in small integers then
// give integers).
template <class Real>
bool ExtendedPolish<Real>::farkas(ActiveRows& active, Index row, Solution& s) {
  using std::abs;
  express(active, {&row, 1});
  open_.assign(1, 0);
  express_again(active, {&row, 1});
  const Real sign = w_->equality[at(row)] && violation(row) < 0 ? -1 : 1;
  const auto multiplier = [&](Index i, Real unit) { return sign * unit / Real(w_->row_norm[i]); };
  Real first = abs(multiplier(row, Real(1))), smallest = first, largest = first;
  for (Index i = 0; i < active.size(); ++i) {
    Real& mu = mu_(i, 0);
    const bool wrong = !w_->equality[at(active[i])] && sign * mu > 0;
    if (wrong && abs(mu) >= tolerances::exchange_part) return false;
    if (wrong || abs(mu) <= tolerances::extended_multiplier * real_eps) mu = 0;
    if (mu == 0) continue;
    const Real u = abs(multiplier(active[i], mu));
    smallest = std::min(smallest, u);
    largest = std::max(largest, u);
  }
  for (const Real unit : {first, smallest, largest}) {
    certificate_.setZero(p_->rows());
    certificate_[w_->row[at(row)]] = static_cast<double>(multiplier(row, Real(1)) / unit);
    for (Index i = 0; i < active.size(); ++i)
      certificate_[w_->row[at(active[i])]] = static_cast<double>(-multiplier(active[i], mu_(i, 0)) / unit);
    if (proves(s)) return true;
  }
  return false;
}

// As a row sign (G_A' mu_ + rest) enters, expressed by that column.
template <class Real>
Blocking<Real> ExtendedPolish<Real>::blocking(const ActiveRows& active, Index column, Real sign) const {
  Blocking<Real> first{.row = -1, .step = std::numeric_limits<double>::infinity()};
  for (Index i = 0; i < active.size(); ++i) {
    const Real rate = sign * mu_(i, column);
    if (w_->equality[at(active[i])] || rate < tolerances::exchange_part) continue;
    const Real step = std::max(unit(active[i]), Real(0)) / rate;
    if (step < first.step) first = {i, step};
  }
  return first;
}

// How far z moves when a row with that share, violated by so much, is obeyed and another gives way to it: until that
// leaves, and then by what is left of the violation over the share that leaving gave it.
template <class Real>
double ExtendedPolish<Real>::detour(const ActiveRows& active, Index column, Real sign, double share,
                                    double violation) const {
  const Blocking<Real> first = blocking(active, column, sign);
  if (first.row < 0) return std::numeric_limits<double>::infinity();
  const double rate = std::abs(static_cast<double>(mu_(first.row, column)));
  return share * static_cast<double>(first.step) + violation / (rate * active.smallest_pivot());
}

// The violated row depends on the active ones: it takes the place of the one whose multiplier reaches zero first.
template <class Real>
bool ExtendedPolish<Real>::exchange(ActiveRows& active, Index row) {
  const Index leaving = blocking(active, 0, w_->equality[at(row)] && b_[row] < 0 ? -1 : 1).row;
  if (leaving < 0) return false;
  remove(active, leaving);
  if (!active.accepts(active.append(row))) return false;
  state_[at(row)] = State::inside;
  return true;
}

template <class Real>
bool ExtendedPolish<Real>::certify(const Problem& p, const Whitened& w, ActiveRows& active,
                                   std::span<const Index> support, Solution& s) {
  prepare(p, w);
  for (const Index i : support) {
    if (active.share(i) > tolerances::certain_share && active.accepts(active.append(i))) continue;
    if (farkas(active, i, s)) return true;
  }
  return false;
}

// What rounding in Real hides in the active rows' violations, over the smallest pivot, and in the sum of their forces.
template <class Real>
double ExtendedPolish<Real>::doubt_active(const ActiveRows& active) {
  double square = 0, forces = 0;
  for (const Index i : active.rows()) square += hidden(i) * hidden(i), forces += std::abs(static_cast<double>(unit(i)));
  return tolerances::pivot_margin * std::sqrt(square) / active.smallest_pivot() + real_eps * forces;
}

// What the residuals of the active rows, and rounding in them, can make of a row g = G_A' mu_.
template <class Real>
double ExtendedPolish<Real>::inherited(const ActiveRows& active, Index column) {
  using std::abs;
  double sum = 0;
  for (Index i = 0; i < active.size(); ++i)
    sum += std::abs(static_cast<double>(mu_(i, column))) *
           (std::abs(static_cast<double>(violation(active[i]))) + hidden(active[i]));
  return sum;
}

// A row outside that is violated by v, or by what rounding and z's error hide, and has a share rho outside the active
// ones would move z by v / rho if obeyed, unless an active row gives way to it first: nothing when it is an exact
// combination or a neighbour's twin, much when it was only taken for one. One that is violated by more than rounding
// and its parts in the combination explain, however little, has to be obeyed: it is returned, and where it could not
// enter before, nobody gave way, so it contradicts the others, provably or not. Returns -1 where there is none.
template <class Real>
Index ExtendedPolish<Real>::doubt_others(ActiveRows& active, double limit, bool passes_on) {
  const double touch = epsilon * scale_, needless = tolerances::needless * scale_;
  hidden_in_z_ = error_ > touch ? error_ : 0;
  share_.assign(at(w_->rows()), unknown);
  touching_.clear();
  asked_.clear();
  is_blurred_ = false;
  for (Index i = 0; i < w_->rows(); ++i) {
    if (state_[at(i)] == State::inside) continue;
    const Real most = doubt(i).most;
    if (most > -touch && touching_.empty()) touched_ = std::max(0.0, static_cast<double>(most));
    if (most > -touch) touching_.push_back(i);
    const bool may_move = most + tolerances::wide_violation * hidden(i) > needless * tolerances::rank * real_eps;
    if (may_move || (has_faint_ && most > -touch)) asked_.push_back(i);
  }
  const auto together = at(passes_on ? 1 : active.together());  // the first that blurs is the last
  std::span<const Index> left(asked_);
  Index entering = -1;
  while (!left.empty() && entering < 0 && !(is_blurred_ && passes_on)) {
    entering = doubt_these(active, left.first(std::min(together, left.size())), limit, passes_on);
    left = left.subspan(std::min(together, left.size()));
  }
  if (entering < 0 && !(is_blurred_ && passes_on)) is_blurred_ = wedge() || is_blurred_;
  return entering;
}

template <class Real>
auto ExtendedPolish<Real>::doubt(Index i) -> Doubt {
  const double rounding = hidden(i);
  const Real v = violation(i), sign = w_->equality[at(i)] && v < 0 ? -1 : 1;
  return {sign, sign * v + (rounding + hidden_in_z_), static_cast<double>(sign * v) - tolerances::violation * rounding};
}

template <class Real>
Index ExtendedPolish<Real>::doubt_these(ActiveRows& active, std::span<const Index> rows, double limit, bool passes_on) {
  const Index a = active.size();
  const double needless = tolerances::needless * scale_;
  const bool clear = active.smallest_pivot() > tolerances::clear_pivot;
  express(active, rows);
  again_.clear();
  for (Index c = 0; c < std::ssize(rows); ++c) {  // as double sees it
    const auto [sign, most, over] = doubt(rows[at(c)]);
    const double share = share_[at(rows[at(c)])] = rest_of_[c];
    if (share > tolerances::clear_share && static_cast<double>(most) <= needless * share) continue;
    if (!(over > 0) && clear) {
      const double rest = share + tolerances::rank * epsilon * (1 + T_.col(c).head(a).template lpNorm<1>());
      const double far = detour(active, c, sign, rest, static_cast<double>(most));
      if (far <= limit) {
        error_ = std::max(error_, far);
        continue;
      }
    }
    is_blurred_ = is_blurred_ || !(over > 0 || share > tolerances::clear_share);
    if (is_blurred_ && passes_on) break;
    again_.push_back(c);
  }
  open_ = again_;
  express_again(active, rows);
  for (const Index c : again_) {
    const auto [sign, most, over] = doubt(rows[at(c)]);
    const double rho = rest_of_[c];
    const double weight = 1 + mu_.col(c).head(a).template cast<double>().template lpNorm<1>();
    const bool combination = !(rho > tolerances::rank * real_eps * weight);
    const bool violated =
        over > 0 && (combination || over > needless * rho) && over > tolerances::violation * inherited(active, c);
    if (violated && state_[at(rows[at(c)])] == State::outside) return rows[at(c)];
    is_blurred_ = is_blurred_ || (combination && !violated);
    const double left = combination && !violated ? left_of(rows[at(c)], active.rows(), mu_.col(c).head(a)) : rho;
    if (!(left > 0)) continue;
    const double own = static_cast<double>(most) + (combination ? inherited(active, c) : 0);
    double far = own / left;
    if (!violated) far = std::min(far, detour(active, c, sign, left, own));
    error_ = std::max(error_, std::min(scale_, far));
  }
  return -1;
}

// How long that unit row less a combination of others is, in the columns where their own entries do not cancel. Beside
// an entry of 1 one of 1e-33, the square of a right angle's cosine, is nothing to the row's length, and all there is in
// its column.
template <class Real>
double ExtendedPolish<Real>::left_of(Index row, std::span<const Index> others, const auto& mu) {
  using std::abs;
  const double cancelled = std::sqrt(real_eps);
  force_.setZero();
  r1_.setZero();
  double weight = 0;
  const auto take = [&](Index i, const Real& factor) {
    add_row(i, factor / Real(w_->row_norm[i]), force_);
    for (RowMatrix::InnerIterator it(p_->J, w_->row[at(i)]); it; ++it)
      r1_[it.col()] += std::abs(it.value()) / w_->row_norm[i];
    weight += static_cast<double>(abs(factor));
  };
  take(row, Real(1));
  for (std::size_t k = 0; k < others.size(); ++k) take(others[k], -mu[static_cast<Index>(k)]);
  for (Index j = 0; j < force_.size(); ++j) {
    const double entry = static_cast<double>(force_[j]);
    r1_[j] = std::abs(entry) > cancelled * weight * r1_[j] ? entry : 0;
  }
  if (r1_.size() > 0) w_->factor.solve_lower(r1_);
  return r1_.norm();
}

// Whether rows that touch are all but opposed. What rounding hides of two, over their opening, may be any motion.
template <class Real>
bool ExtendedPolish<Real>::wedge() {
  bool found = false;
  for (std::size_t i = 0; i + 1 < touching_.size(); ++i) {
    const Index first = touching_[i];
    wedge_.setZero(r1_.size());
    w_->add(first, 1.0, wedge_);
    for (const Index k : std::span(touching_).subspan(i + 1)) {
      if (!(w_->dot(k, wedge_) < tolerances::clear_pivot - 1)) continue;
      found = true;
      const double most = static_cast<double>(doubt(first).most + doubt(k).most);
      const double opens = most > 0 ? left_of(k, {&first, 1}, Vec<double, 1>(-1)) : 0;
      if (opens > 0) error_ = std::max(error_, std::min(scale_, most / opens));
    }
  }
  return found;
}

template <class Real>
void ExtendedPolish<Real>::write(Solution& s) const {
  using std::ldexp;
  s.z = z_.template cast<double>();
  s.lambda.setZero(p_->rows());
  for (Index i = 0; i < w_->rows(); ++i) {
    const Real own = w_->equality[at(i)] ? l_[i] : std::max(l_[i], Real(0));
    s.lambda[w_->row[at(i)]] = static_cast<double>(ldexp(own, w_->exponent));
  }
}

// z is the projection of z_u onto the active rows, so z_u - z is in their span. A point that meets all rows, away from
// z across that span, is as far as the answer can be: the projection lies no farther. One row that touches is met at
// what it may be short of, over its share. Of several that all but depend on each other no such point may be near.
// Multipliers that pull, and are cut off, move y by no more than they are. What M ties enlarges rounding in residuals.
template <class Real>
double ExtendedPolish<Real>::bound(ActiveRows& active) {
  const double rest = touching_.size() == 1 ? share(active, touching_[0]) : 1;
  const double across = touching_.size() == 1 ? (touched_ + error_) / rest : 0;
  const bool clear = std::min(rest, active.smallest_pivot()) > tolerances::clear_pivot;
  if (touching_.size() > 1 || !clear || !(error_ + across <= epsilon * scale_)) return bound_beside(active);
  double most =
      2 * error_ + across + tolerances::violation * real_eps * static_cast<double>(w_->factor.tied()) * scale_;
  for (const Index i : active.rows())
    if (!w_->equality[at(i)]) most += std::max(0.0, -static_cast<double>(unit(i)));
  return relative_bound(most, length_, z_u_length_);
}

// Where more rows touch, or rows depend on each other: at a point that meets all, along the shortest motion that opens
// each active row by one. Where equality rows repeat each other there is none (infinite), also not by promise.h.
template <class Real>
double ExtendedPolish<Real>::bound_beside(ActiveRows& active) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  if (std::ranges::count(w_->equality, 1) > 0)
    return std::ranges::any_of(touching_, [&](Index i) { return w_->equality[at(i)] != 0; }) ? infinity : unknown;
  const double enough = std::sqrt(epsilon) * scale_;
  double unbalanced = 2 * error_ + tolerances::violation * real_eps * static_cast<double>(w_->factor.tied()) * scale_;
  near_.clear();
  for (Index i = 0; i < w_->rows(); ++i) {
    const double violation = static_cast<double>(rest(i).violation), push = static_cast<double>(unit(i));
    if (push == 0 && !(violation > -2 * enough)) continue;
    near_.push_back({i, violation + hidden(i), hidden(i) - violation, push});
    unbalanced += std::max(0.0, -push);
  }
  auto r2 = r2_.head(active.size());
  r1_.setZero();
  r2.setOnes();
  active.correct(r1_, r2);
  open_all(*w_, near_, epsilon * scale_, r1_);
  const double most = bound_inside(near_, r1_.norm(), unbalanced, tolerances::violation * epsilon);
  return most <= enough ? relative_bound(most, length_, z_u_length_) : unknown;
}

// Rows outside that hold with equality all the same are ignored; those that the active ones determine are redundant.
template <class Real>
void ExtendedPolish<Real>::name_redundant(ActiveRows& active, Solution& s) {
  using std::abs;
  for (Index i = 0; i < w_->rows(); ++i)
    if (state_[at(i)] == State::outside &&
        abs(violation(i)) <= tolerances::touching * (Real(w_->magnitude[i]) + length_))
      state_[at(i)] = State::ignored;
  s.redundant.reserve(at(w_->rows()) + w_->idle.size());
  s.redundant.assign(w_->idle.begin(), w_->idle.end());
  s.margins = {.rank = active.size()};
  if (active.size() > 0) s.margins.smallest_accepted = active.smallest_pivot();
  for (Index i = 0; i < w_->rows(); ++i) {
    if (state_[at(i)] != State::ignored) continue;
    const double rest = share(active, i);
    if (rest > tolerances::redundant_share) continue;
    s.redundant.push_back(w_->row[at(i)]);
    s.margins.largest_rejected =
        std::isnan(s.margins.largest_rejected) ? rest : std::max(s.margins.largest_rejected, rest);
  }
  std::sort(s.redundant.begin(), s.redundant.end());
}

template <class Real>
bool ExtendedPolish<Real>::certify(const Problem& p, const Whitened& w, const Vector& unit, Solution& s) {
  prepare(p, w);
  const double largest = unit.lpNorm<Eigen::Infinity>();
  certificate_.setZero(p.rows());
  for (Index i = 0; i < w.rows(); ++i)
    if (w.equality[at(i)] || unit[i] > 0) certificate_[w.row[at(i)]] = unit[i] / largest / w.row_norm[i];
  return largest > 0 && proves(s);
}

template <class Real>
bool ExtendedPolish<Real>::run(const Problem& p, const Whitened& w, ActiveRows& active, const SolveOptions& options,
                               Solution& s, bool passes_on) {
  // Where the refinement does not converge, a contact this near to a combination of the others gives way: its
  // neighbours do what it did, and where they do not, it is found violated again and judged as dependent.
  prepare(p, w);
  for (const Index i : active.rows()) state_[at(i)] = State::inside;
  const Index rounds = 20 + 2 * w.rows();
  bool left_out = false;  // a row that is violated and could not enter
  for (Index round = 0; round < rounds; ++round) {
    if (round > 0) s.fallback = true;
    if (!refine(active)) {
      const Index weakest = active.coarsen(tolerances::weak_pivot);
      if (weakest >= 0) {
        remove(active, weakest);
        continue;
      }
      s.message = "the active rows are too close to dependent to be told apart";
      break;
    }
    if (const Index leaving = pulling_row(active); leaving < active.size()) {
      remove(active, leaving);
      continue;
    }

    const double limit = accepted_error(options.tolerance) * scale_;
    Real worst = tolerances::wide_violation * real_eps;
    Index entering = violated_row(worst);
    if (entering < 0) {
      error_ += doubt_active(active);
      entering = doubt_others(active, limit, passes_on);
    }
    if (entering < 0) {
      write(s);
      const bool left_to_others = passes_on && (is_blurred_ || left_out);
      s.status = left_to_others || left_out || error_ > limit ? Status::solved_ill_conditioned : Status::solved;
      if (left_to_others) return true;
      name_redundant(active, s);
      if (options.has_accuracy()) s.error_bound = bound(active);
      return true;
    }
    const double share = active.append(entering);
    if (active.accepts(share)) {
      state_[at(entering)] = State::inside;
      continue;
    }
    if (active.undecided(share)) {
      s.message = "a violated row is too close to a combination of the active ones";
      break;
    }
    if (farkas(active, entering, s)) return true;
    if (exchange(active, entering)) continue;
    if (worst > tolerances::dependent_violation) {
      s.message = "a row that depends on others to rounding contradicts them, but not provably";
      break;
    }
    state_[at(entering)] = State::ignored;
    left_out = true;
  }
  if (s.message.empty()) s.message = "no consistent active set was found";
  s.status = Status::numerical_failure;
  write(s);
  return false;
}

template class ExtendedPolish<long double>;
template class ExtendedPolish<DoubleDouble>;

}  // namespace zwang
