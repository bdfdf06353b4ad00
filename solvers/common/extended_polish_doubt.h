#pragma once

#include <algorithm>
#include <cmath>

#include <zwang/solvers/common/extended_polish.h>

// What the polish says of its own answer: how far rounding may have moved z, and which rows it left out.

namespace zwang {

// What rounding can hide in a violation.
template <class Real>
double ExtendedPolish<Real>::hidden(const Problem& p, const Whitened& w, Index i) const {
  using std::abs, std::ldexp;
  Real terms = abs(Real(p.c[w.row[at(i)]]));
  for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, w.row[at(i)]); it; ++it)
    terms += abs(Real(it.value()) * z_[it.col()]);
  return static_cast<double>(ldexp(Real(real_eps * terms / Real(w.row_norm[i])), -w.exponent));
}

template <class Real>
void ExtendedPolish<Real>::doubt_active(const Problem& p, const Whitened& w, const ActiveRows& active) {
  double square = 0;
  for (const Index i : active.rows()) square += hidden(p, w, i) * hidden(p, w, i);
  constexpr int margin = 4;  // the smallest pivot may be larger than the smallest singular value
  error_ += margin * std::sqrt(square) / active.smallest_pivot();
}

// What the residuals of the active rows, and rounding in them, can make of a row g = G_A' mu_.
template <class Real>
double ExtendedPolish<Real>::inherited(const Problem& p, const Whitened& w, const ActiveRows& active) const {
  using std::abs;
  double sum = 0;
  for (Index i = 0; i < active.size(); ++i)
    sum += std::abs(static_cast<double>(mu_[i])) *
           (std::abs(static_cast<double>(violation(p, w, active[i]))) + hidden(p, w, active[i]));
  return sum;
}

// A row outside that is violated by v, or by what rounding hides, and has a share rho outside the active ones would
// move z by v / rho if it were obeyed, unless an active row gives way to it first: nothing when it is an exact
// combination or a neighbour's twin, much when it was only taken for one. One that is violated by more than rounding
// and its parts in the combination explain, however little, has to be obeyed: it is returned, and where it could not
// enter before, nobody gave way, so it contradicts the others, provably or not. Returns -1 where there is none.
template <class Real>
Index ExtendedPolish<Real>::doubt_others(const Problem& p, Whitened& w, ActiveRows& active) {
  constexpr double clear_share = 1e-12;  // as double factors see it
  for (Index i = 0; i < w.rows(); ++i) {
    if (state_[at(i)] == State::inside) continue;
    const double rounding = hidden(p, w, i);
    const Real v = violation(p, w, i), sign = w.equality[at(i)] && v < 0 ? -1 : 1, most = sign * v + rounding;
    if (!(most > 0)) continue;
    const double share = active.share(i), needless = 1e-13 * scale_;
    if (share > clear_share && static_cast<double>(most) <= needless * share) continue;
    const double rho = express(p, w, active, i);
    const double weight = 1 + mu_.head(active.size()).template cast<double>().template lpNorm<1>();
    const bool combination = !(rho > 64 * real_eps * weight);
    const double over = static_cast<double>(sign * v) - 8 * rounding;
    const bool violated = over > 0 && (combination || over > needless * rho) && over > 8 * inherited(p, w, active);
    if (violated && state_[at(i)] == State::outside) return i;
    if (combination && !violated) continue;
    double far = static_cast<double>(most) / rho;
    if (Index leaving; !violated) far = std::min(far, rho * static_cast<double>(give_way(w, active, sign, leaving)));
    error_ = std::max(error_, std::min(scale_, far));
  }
  return -1;
}

template <class Real>
void ExtendedPolish<Real>::write(const Problem& p, const Whitened& w, Solution& s) const {
  using std::ldexp;
  s.z = z_.template cast<double>();
  s.lambda.setZero(p.rows());
  for (Index i = 0; i < w.rows(); ++i) {
    const Real unit = w.equality[at(i)] ? l_[i] : std::max(l_[i], Real(0));
    s.lambda[w.row[at(i)]] = static_cast<double>(ldexp(Real(unit / Real(w.row_norm[i])), w.exponent));
  }
}

// Rows outside that hold with equality all the same are ignored; those that the active ones determine are redundant.
template <class Real>
void ExtendedPolish<Real>::name_redundant(const Problem& p, const Whitened& w, ActiveRows& active, Solution& s) {
  using std::abs;
  for (Index i = 0; i < w.rows(); ++i)
    if (state_[at(i)] == State::outside && abs(violation(p, w, i)) <= 1e-12 * (Real(w.magnitude[i]) + length_))
      state_[at(i)] = State::ignored;
  s.redundant.reserve(at(w.rows()) + w.idle.size());
  s.redundant.assign(w.idle.begin(), w.idle.end());
  s.margins = {.rank = active.size()};
  if (active.size() > 0) s.margins.smallest_accepted = active.smallest_pivot();
  for (Index i = 0; i < w.rows(); ++i) {
    if (state_[at(i)] != State::ignored) continue;
    const double share = active.share(i);
    if (share > 1e-10) continue;
    s.redundant.push_back(w.row[at(i)]);
    s.margins.largest_rejected =
        std::isnan(s.margins.largest_rejected) ? share : std::max(s.margins.largest_rejected, share);
  }
  std::sort(s.redundant.begin(), s.redundant.end());
}

}  // namespace zwang
