#include <zwang/core/referee/proof.h>

#include <algorithm>
#include <cmath>

#include <zwang/core/problem/row_writer.h>
#include <zwang/core/referee/certificate.h>
#include <zwang/core/referee/exact_rank.h>
#include <zwang/core/referee/referee_active_set.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

using Column = OrthogonalRows::Column;
using Rows = DistanceBound::Rows;

// Rows that hold with equality at every feasible z: the equality rows, and contacts that leave each other no room.
struct Anchored {
  std::vector<char> is;        // m
  std::vector<Index> basis;    // independent ones
  OrthogonalRows factors;      // of the basis
  double sigma_min = 1;        // of the basis, at least
  bool exact = true;           // the others are combinations of the basis, right-hand sides included
  bool contradictory = false;  // combinations on the left only
};

Anchored anchor(const ScaledProblem& scaled, const std::vector<Index>& rows) {
  Anchored a{.is = std::vector<char>(at(scaled.rows()), 0), .basis = {}, .factors = OrthogonalRows(scaled.size())};
  std::vector<Index> dependent;
  for (const Index i : rows) {
    a.is[at(i)] = 1;
    const OrthogonalRows::Split s = a.factors.split(scaled.unit_row(i));
    if (s.dependent) {
      dependent.push_back(i);
      continue;
    }
    a.factors.append(s);
    a.basis.push_back(i);
  }
  a.sigma_min = a.factors.sigma_min(scaled, a.basis);
  if (dependent.empty()) return a;
  const Consistency found = exact_consistency(scaled.J, scaled.c, a.basis, dependent);
  a.exact = found == Consistency::consistent;
  a.contradictory = found == Consistency::contradictory;
  return a;
}

struct Inward {
  bool found = false;
  Vector v;                   // J_E v = 0, unit rows g_i . v >= 1/2 on the near rows
  std::vector<Index> locked;  // when there is none: near rows that leave each other no room
};

// A direction along the anchored rows and into every near row: g_i . v = 1 by least squares where that is consistent,
// otherwise the shortest v with g_i . v >= 1, which is a problem of the same kind.
Inward look_inward(const ScaledProblem& scaled, const Anchored& anchored, const std::vector<Index>& near) {
  Inward out;
  OrthogonalRows rows = anchored.factors;
  std::vector<OrthogonalRows::Real> target(at(rows.rank()), 0);
  for (const Index i : near)
    if (const OrthogonalRows::Split s = rows.split(scaled.unit_row(i)); !s.dependent && s.left > referee::clear_rest) {
      rows.append(s);
      target.push_back(1);
    }
  const Column t = Eigen::Map<const Column>(target.data(), static_cast<Index>(target.size()));
  const Column y = rows.Q() * rows.solve_transposed(t);
  const auto reaches = [&](const Column& direction) {
    return std::ranges::all_of(near, [&](Index i) { return scaled.unit_row(i).dot(direction) >= referee::reaches; });
  };
  out.found = reaches(y);
  if (out.found) {
    out.v = scaled.unwhiten(y).cast<double>();
    return out;
  }

  std::vector<Index> all;
  for (Index i = 0; i < scaled.rows(); ++i)
    if (anchored.is[at(i)]) all.push_back(i);
  const std::size_t anchors = all.size();
  all.insert(all.end(), near.begin(), near.end());
  Problem p{.M = scaled.M, .z_u = Vector::Zero(scaled.size())};
  RowWriter asked;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool equality = k < anchors;
    asked.add(equality ? RowKind::equality : RowKind::inequality, {}, equality ? 0 : scaled.row_norm[all[k]]);
    asked.entries(scaled.J, all[k]);
  }
  asked.write(p);
  const ScaledProblem direction_problem(p);
  RefereeActiveSet direction(direction_problem);
  const RefereeActiveSet::Outcome outcome = direction.solve(ExtendedVector::Zero(scaled.size()), nullptr);
  if (outcome == RefereeActiveSet::Outcome::infeasible) {
    const double largest = direction.farkas.cwiseAbs().maxCoeff();
    for (std::size_t k = anchors; k < all.size(); ++k)
      if (std::abs(direction.farkas[static_cast<Index>(k)]) > referee::locked * largest) out.locked.push_back(all[k]);
  }
  if (outcome != RefereeActiveSet::Outcome::optimal) return out;
  out.v.resize(scaled.size());
  for (Index j = 0; j < scaled.size(); ++j) out.v[j] = std::ldexp(direction.d[j].hi, direction_problem.motion_exponent);
  out.found = true;
  return out;
}

// How far the exact point on the anchored rows can be from d: |slack| / sigma_min.
double off_anchor(const ScaledProblem& scaled, const Anchored& anchored, const ExtendedVector& d) {
  double squared = 0;
  for (const Index i : anchored.basis) {
    const double slack = std::abs(scaled.unit_slack(i, d)) + scaled.rounding(i, d);
    squared += slack * slack;
  }
  return squared == 0 ? 0 : referee::up(std::sqrt(squared)) / anchored.sigma_min;
}

// sqrt(2 gap) at the exact feasible point within `off` of d, or infinity where a row is not surely kept there.
double radius_at(const ScaledProblem& scaled, const Anchored& anchored, const ExtendedVector& d, ExtendedVector lambda,
                 double off) {
  double weighted_slack = 0;
  for (Index i = 0; i < scaled.rows(); ++i) {
    if (!scaled.counts(i)) continue;
    DoubleDouble& weight = lambda[i];
    if (!scaled.is_equality(i) && weight.hi < 0) weight = 0;  // weak duality wants it of anchored contacts as well
    if (anchored.is[at(i)]) continue;
    const double error = scaled.rounding(i, d) + off, slack = scaled.unit_slack(i, d);
    if (!(slack >= error)) return infinity;
    weighted_slack += weight.hi * scaled.row_norm[i] * (slack + error);
  }
  const double residual = scaled.dual_norm(scaled.force_residual(d, lambda)) + scaled.force_rounding(d, lambda) + off;
  return referee::widened_sum * std::sqrt(residual * residual + 2 * weighted_slack);
}

// Let d be the answer of RefereeActiveSet and lambda_I >= 0 its multipliers. For ANY feasible d~,  1/2 |d~ - d*|_M^2 <=
// gap(d~, lambda) (weak duality), without a condition on the rows that hold: redundant, weakly active and nearly
// parallel rows need no case of their own. What remains is a point d~ that is feasible beyond doubt, for the rows
// `near` zero slack:
//   - anchored: independent rows hold exactly at a point within |slack| / sigma_min of d, and rows that are exact
//     combinations of them (exact_rank.h) hold there too;
//   - or moved inward: eps v added to d, eps about 1e-29, J_E v = 0 and g_i . v >= 1/2 on near rows, equality rows
//     anchored. Rows that leave each other no room for a v count as equality rows.
// The first leaves a gap of about 1e-60 but wants exact consistency; the second stops at sqrt(1e-29). In double both
// would stop at 1e-8. An earlier form compared |slack_A| / sigma_min(G_A) with the slack of the other rows and with the
// multipliers: it decides nothing at weakly active or redundant rows, and hands touch with redundant rows all the time.
class DistanceProof {
 public:
  DistanceProof(const ScaledProblem& scaled, const RefereeActiveSet& own) : scaled_(scaled), own_(own) {
    for (Index i = 0; i < scaled.rows(); ++i)
      if (scaled.is_equality(i) && scaled.counts(i)) equality_.push_back(i);
  }

  Proof prove() {
    anchor_everything();
    if (proof_.radius > referee::sharp_enough * scaled_.norm(own_.d) && proof_.rows != Rows::infeasible) move_inward();
    return std::move(proof_);
  }

 private:
  std::vector<Index> near_rows(const Anchored& anchored, double off) const {
    std::vector<Index> near;
    for (Index i = 0; i < scaled_.rows(); ++i)
      if (scaled_.counts(i) && !anchored.is[at(i)] &&
          scaled_.unit_slack(i, own_.d) <= referee::near * (scaled_.rounding(i, own_.d) + off))
        near.push_back(i);
    return near;
  }

  void keep(const ExtendedVector& d, double radius, double sigma_min) {
    if (!(radius < proof_.radius)) return;
    proof_.rows = Rows::feasible;
    proof_.d = d;
    proof_.radius = radius;
    proof_.sigma_min = sigma_min;
  }

  void anchor_everything() {
    Anchored anchored = anchor(scaled_, equality_);
    if (anchored.contradictory) {
      proof_.rows = Rows::infeasible;
      proof_.farther_than = infinity;
    }
    if (!anchored.exact) return;
    std::vector<Index> all = equality_;
    for (const Index i : near_rows(anchored, off_anchor(scaled_, anchored, own_.d))) all.push_back(i);
    if (all.size() > equality_.size()) anchored = anchor(scaled_, all);
    if (!anchored.exact) return;
    const double off = off_anchor(scaled_, anchored, own_.d);
    keep(own_.d, off + radius_at(scaled_, anchored, own_.d, own_.lambda, off), anchored.sigma_min);
  }

  void move_inward() {
    std::vector<Index> holding = equality_;
    for (int round = 0; round < referee::inward_attempts; ++round) {
      const Anchored anchored = anchor(scaled_, holding);
      if (!anchored.exact) return;
      const double off = off_anchor(scaled_, anchored, own_.d);
      const std::vector<Index> near = near_rows(anchored, off);
      if (near.empty()) return;
      const Inward inward = look_inward(scaled_, anchored, near);
      if (inward.found) {
        ExtendedVector inside = own_.d;
        double shift = 0;
        for (const Index i : near)
          shift = std::max(shift, referee::inward * (std::max(-scaled_.unit_slack(i, own_.d), 0.0) +
                                                     scaled_.rounding(i, own_.d) + off));
        for (Index j = 0; j < inside.size(); ++j) inside[j] += DoubleDouble::exact_product(shift, inward.v[j]);
        const double left = off_anchor(scaled_, anchored, inside);
        keep(inside, left + radius_at(scaled_, anchored, inside, own_.lambda, left), anchored.sigma_min);
        return;
      }
      if (inward.locked.empty()) return;
      holding.insert(holding.end(), inward.locked.begin(), inward.locked.end());
    }
  }

  const ScaledProblem& scaled_;
  const RefereeActiveSet& own_;
  std::vector<Index> equality_;
  Proof proof_;
};

}  // namespace

Proof prove_answer(const ScaledProblem& scaled, const ExtendedVector& guess_d, const ExtendedVector* guess_lambda,
                   double motion) {
  RefereeActiveSet own(scaled);
  const RefereeActiveSet::Outcome outcome = own.solve(guess_d, guess_lambda);
  if (outcome == RefereeActiveSet::Outcome::optimal) return DistanceProof(scaled, own).prove();
  Proof proof;
  if (outcome == RefereeActiveSet::Outcome::gave_up) return proof;
  const Farkas farkas = judge_certificate(scaled, own.farkas, motion);
  if (farkas.proven) {
    proof.rows = Rows::infeasible;
    proof.farther_than = farkas.distance / referee::widened_sum;
  }
  return proof;
}

}  // namespace zwang
