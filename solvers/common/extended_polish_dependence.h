#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <zwang/solvers/common/extended_polish.h>

// A violated row that depends on the active ones: how, who gives way to it, and the proof where nobody can.

namespace zwang {

// g_row = G_A' mu + rest; returns the length of the rest. Ends when a correction is nothing to mu: among rows of small
// integers, corrections would otherwise shrink down to 1e-100.
template <class Real>
double ExtendedPolish<Real>::express(const Problem& p, Whitened& w, ActiveRows& active, Index row) {
  const Index a = active.size();
  auto t = t_.head(a);
  mu_.head(a).setZero();
  double last = std::numeric_limits<double>::infinity();
  for (int step = 0;; ++step) {
    force_.setZero();
    add_row(p, w, row, Real(1), force_);
    for (Index i = 0; i < a; ++i) add_row(p, w, active[i], -mu_[i], force_);
    r1_ = force_.template cast<double>();
    w.factor.solve_lower(r1_);
    active.combine(r1_, t);
    mu_.head(a) += t.template cast<Real>();
    const double change = t.norm(), weight = 1 + mu_.head(a).template cast<double>().template lpNorm<1>();
    if (change <= real_eps * weight || (step > 2 && !(change < last / 2))) return r1_.norm();
    last = change;
  }
}

// Joints that a weld repeats agree to the rounding of their poses only; the contacts then take a share of 1e-17 in the
// combination, of either sign. What has the wrong sign and cannot give way in exchange() is cut off: the proof is
// judged without it. u = +-(e_row - mu) proves infeasibility when u_I >= 0 and h'u / |G'u| is beyond any motion of this
// problem: the referee's bound. It is judged after rounding to double, so of three normalizations the one that rounds
// best is kept (rows in small integers then give integers).
// |G'u| beyond row_rounding of sum |u_i| is not the rounding of the rows, but a way to meet them, however far away. A
// wedge with an opening of 2^-46 and z_u = 0 has no length but that opening: its only motion, of length 1, is 2^46
// times as long, and the referee's 1e8 alone would call it contradicting.
template <class Real>
bool ExtendedPolish<Real>::farkas(const Problem& p, Whitened& w, const ActiveRows& active, Index row, Solution& s) {
  using std::abs;
  constexpr double row_rounding = 8 * std::numeric_limits<double>::epsilon();
  const Real sign = violation(p, w, row) < 0 ? -1 : 1;
  const auto multiplier = [&](Index i, Real unit) { return sign * unit / Real(w.row_norm[i]); };
  Real first = abs(multiplier(row, Real(1))), smallest = first, largest = first;
  for (Index i = 0; i < active.size(); ++i) {
    Real& mu = mu_[i];
    const bool wrong = !w.equality[at(active[i])] && sign * mu > 0;
    if (wrong && abs(mu) >= giving) return false;
    if (wrong || abs(mu) <= 16 * real_eps) mu = 0;
    if (mu == 0) continue;
    const Real u = abs(multiplier(active[i], mu));
    smallest = std::min(smallest, u);
    largest = std::max(largest, u);
  }
  for (const Real unit : {first, smallest, largest}) {
    certificate_.setZero(p.rows());
    certificate_[w.row[at(row)]] = static_cast<double>(multiplier(row, Real(1)) / unit);
    for (Index i = 0; i < active.size(); ++i)
      certificate_[w.row[at(active[i])]] = static_cast<double>(-multiplier(active[i], mu_[i]) / unit);
    Real work = 0, noise = 0, weight = 0;
    force_.setZero();
    const auto add = [&](Index i) {
      const Real u = Real(certificate_[w.row[at(i)]]) * Real(w.row_norm[i]);
      work += u * b_[i];
      noise += abs(u) * Real(w.magnitude[i]);
      weight += abs(u);
      add_row(p, w, i, u, force_);
    };
    add(row);
    for (const Index i : active.rows()) add(i);
    r1_ = (force_ / noise).template cast<double>();
    w.factor.solve_lower(r1_);
    const double reach = std::max({z_u_length_, w.h.lpNorm<Eigen::Infinity>()});
    const bool parallel = r1_.norm() <= row_rounding * static_cast<double>(weight / noise);
    const double rest = r1_.norm() + real_eps * static_cast<double>(weight / noise);  // and what rounding in Real hides
    if (parallel && work > 8 * real_eps * noise &&
        static_cast<double>(work / noise) >= tolerances::out_of_reach * reach * rest) {
      s.zero_certificate(p.rows()) = certificate_;
      return true;
    }
  }
  return false;
}

// How far the multiplier of a row sign (G_A' mu_ + rest) can grow before that of an active row, `leaving`, is zero.
template <class Real>
Real ExtendedPolish<Real>::give_way(const Whitened& w, const ActiveRows& active, Real sign, Index& leaving) const {
  Real shortest = std::numeric_limits<double>::infinity();
  leaving = active.size();
  for (Index i = 0; i < active.size(); ++i) {
    const Real rate = sign * mu_[i];
    if (w.equality[at(active[i])] || rate < giving) continue;
    const Real step = std::max(l_[active[i]], Real(0)) / rate;
    if (step < shortest) {
      shortest = step;
      leaving = i;
    }
  }
  return shortest;
}

// The violated row depends on the active ones: it takes the place of the one whose multiplier reaches zero first.
template <class Real>
bool ExtendedPolish<Real>::exchange(const Whitened& w, ActiveRows& active, Index row) {
  Index leaving;
  give_way(w, active, w.equality[at(row)] && b_[row] < 0 ? -1 : 1, leaving);
  if (leaving == active.size()) return false;
  remove(active, leaving);
  if (!active.accepts(active.append(row))) return false;
  state_[at(row)] = State::inside;
  return true;
}

template <class Real>
bool ExtendedPolish<Real>::certify(const Problem& p, Whitened& w, ActiveRows& active, std::span<const Index> support,
                                   Solution& s) {
  prepare(p, w);
  for (const Index i : support) {
    if (active.share(i) > 1e-9 && active.accepts(active.append(i))) continue;
    express(p, w, active, i);
    if (farkas(p, w, active, i, s)) {
      s.status = Status::infeasible;
      return true;
    }
  }
  return false;
}

}  // namespace zwang
