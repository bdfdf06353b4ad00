#include <zwang/solvers/common/extended_polish.h>

#include <algorithm>
#include <cmath>

#include <zwang/solvers/common/extended_polish_dependence.h>
#include <zwang/solvers/common/extended_polish_doubt.h>

namespace zwang {

template <class Real>
void ExtendedPolish<Real>::add_row(const Problem& p, const Whitened& w, Index i, Real factor, RealVector& v) const {
  factor = factor / Real(w.row_norm[i]);
  for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, w.row[at(i)]); it; ++it)
    v[it.col()] += Real(it.value()) * factor;
}

// From z, not from z - z_u: a mechanism at rest then leaves residuals of zero from terms of zero.
template <class Real>
Real ExtendedPolish<Real>::violation(const Problem& p, const Whitened& w, Index i) const {
  using std::ldexp;
  Real rest = p.c[w.row[at(i)]];
  for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, w.row[at(i)]); it; ++it)
    rest -= Real(it.value()) * z_[it.col()];
  return ldexp(Real(rest / Real(w.row_norm[i])), -w.exponent);
}

template <class Real>
void ExtendedPolish<Real>::prepare(const Problem& p, Whitened& w) {
  using std::ldexp, std::sqrt;
  const Index n = p.size(), k = w.rows();
  z_ = p.z_u.template cast<Real>();
  l_.setZero(k);
  u_.setZero(k);
  b_.resize(k);
  force_.resize(n);
  mu_.resize(std::min(n, k));
  r1_.resize(n);
  r2_.resize(std::min(n, k));
  t_.resize(std::min(n, k));
  state_.assign(at(k), State::outside);
  for (Index i = 0; i < k; ++i) {
    Real sum = p.c[w.row[at(i)]];
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, w.row[at(i)]); it; ++it)
      sum -= Real(it.value()) * Real(p.z_u[it.col()]);
    b_[i] = ldexp(Real(sum / Real(w.row_norm[i])), -w.exponent);
  }
  Real square = 0;
  for (Index j = 0; j < n; ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(p.M, j); it; ++it)
      square += Real(p.z_u[it.row()]) * it.value() * p.z_u[j];
  z_u_length_ = static_cast<double>(ldexp(sqrt(std::max(square, Real(0))), -w.exponent));
}

// False when neither the corrections of z nor the forces that the multipliers leave unbalanced shrink: the factors no
// longer describe the rows. (Looking at z alone took a dependent row with a pivot of 1.5e-14 and a multiplier of 4e17
// for solved.)
template <class Real>
bool ExtendedPolish<Real>::refine(const Problem& p, Whitened& w, ActiveRows& active) {
  using std::ldexp, std::sqrt;
  const Index n = p.size(), a = active.size();
  auto r2 = r2_.head(a);
  double last = std::numeric_limits<double>::infinity();
  constexpr int most_steps = 60;
  for (int step = 0; step < most_steps; ++step) {
    force_.setZero();
    for (const Index i : active.rows()) add_row(p, w, i, l_[i], force_);
    for (Index j = 0; j < n; ++j) {
      const Real d = ldexp(z_[j] - Real(p.z_u[j]), -w.exponent);
      for (Eigen::SparseMatrix<double>::InnerIterator it(p.M, j); it; ++it) force_[it.row()] -= Real(it.value()) * d;
    }
    r1_ = force_.template cast<double>();
    if (n > 0) w.factor.solve_lower(r1_);
    for (Index i = 0; i < a; ++i) r2[i] = static_cast<double>(violation(p, w, active[i]));

    const double unbalanced = r1_.norm();
    active.correct(r1_, r2);
    for (Index i = 0; i < a; ++i) l_[active[i]] += Real(r2[i]);
    const double length = std::max(r1_.norm(), unbalanced);
    if (n > 0) w.factor.solve_upper(r1_);
    for (Index j = 0; j < n; ++j) z_[j] += ldexp(Real(r1_[j]), w.exponent);

    Real square = 0;
    for (const Index i : active.rows()) square += l_[i] * b_[i];  // |y|^2 = l'b at the solution
    length_ = static_cast<double>(sqrt(std::max(square, Real(0))));
    scale_ = std::max(z_u_length_, length_);
    error_ = length;
    if (!std::isfinite(length)) return false;
    if (length <= 10 * real_eps * scale_) return true;
    if (step > 1 && length > 0.3 * last) return length <= 1e-6 * scale_;
    last = length;
  }
  return true;
}

template <class Real>
void ExtendedPolish<Real>::remove(ActiveRows& active, Index position) {
  state_[at(active[position])] = State::outside;
  l_[active[position]] = 0;
  active.drop(position);
}

// The active row with the most negative multiplier, or active.size(). One of 1e-15 s moves z by less than that.
template <class Real>
Index ExtendedPolish<Real>::pulling_row(const Whitened& w, const ActiveRows& active) const {
  Index leaving = active.size();
  Real most = -1e-15 * scale_;
  for (Index i = 0; i < active.size(); ++i)
    if (!w.equality[at(active[i])] && l_[active[i]] < most) {
      most = l_[active[i]];
      leaving = i;
    }
  return leaving;
}

// The most violated row outside, or -1, and how much: its share of its terms, of which less than `worst` is rounding.
template <class Real>
Index ExtendedPolish<Real>::violated_row(const Problem& p, const Whitened& w, Real& worst) const {
  using std::abs;
  Index entering = -1;
  for (Index i = 0; i < w.rows(); ++i) {
    if (state_[at(i)] != State::outside) continue;
    const Real v = violation(p, w, i), size = Real(w.magnitude[i]) + length_;
    const Real relative = (w.equality[at(i)] ? abs(v) : v) / size;
    if (relative > worst) {
      worst = relative;
      entering = i;
    }
  }
  return entering;
}

template <class Real>
PolishOutcome ExtendedPolish<Real>::run(const Problem& p, Whitened& w, ActiveRows& active, double tolerance,
                                        Solution& s) {
  // Where the refinement does not converge, a contact this near to a combination of the others gives way: its
  // neighbours do what it did, and where they do not, it is found violated again and judged as dependent.
  constexpr double coarse = 1e-10;
  prepare(p, w);
  for (const Index i : active.rows()) state_[at(i)] = State::inside;
  const Index rounds = 20 + 2 * w.rows();
  for (Index round = 0; round < rounds; ++round) {
    if (round > 0) s.fallback = true;
    if (!refine(p, w, active)) {
      const Index weakest = active.coarsen(coarse);
      if (weakest >= 0) {
        remove(active, weakest);
        continue;
      }
      s.message = "the active rows are too close to dependent to be told apart";
      break;
    }
    if (const Index leaving = pulling_row(w, active); leaving < active.size()) {
      remove(active, leaving);
      continue;
    }

    Real worst = tolerances::wide_violation * real_eps;
    Index entering = violated_row(p, w, worst);
    if (entering < 0) {
      doubt_active(p, w, active);
      entering = doubt_others(p, w, active);
    }
    if (entering < 0) {
      write(p, w, s);
      name_redundant(p, w, active, s);
      const double limit = accepted_error(tolerance) * scale_;
      s.status = error_ > limit ? Status::solved_ill_conditioned : Status::solved;
      return Outcome::solved;
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
    express(p, w, active, entering);
    if (farkas(p, w, active, entering, s)) {
      s.status = Status::infeasible;
      return Outcome::infeasible;
    }
    if (exchange(w, active, entering)) continue;
    if (worst > 1e-13) {
      s.message = "a row that depends on others to rounding contradicts them, but not provably";
      break;
    }
    state_[at(entering)] = State::ignored;
  }
  if (s.message.empty()) s.message = "no consistent active set was found";
  s.status = Status::numerical_failure;
  write(p, w, s);
  return Outcome::failed;
}

template class ExtendedPolish<long double>;
template class ExtendedPolish<DoubleDouble>;

}  // namespace zwang
