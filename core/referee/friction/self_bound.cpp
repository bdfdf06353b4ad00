#include <zwang/core/referee/friction/self_bound.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>

#include <zwang/core/referee/exact_rank.h>
#include <zwang/core/referee/friction/interior_point.h>
#include <zwang/core/referee/orthogonal_rows.h>

namespace zwang {
namespace {

using referee::or_infinity, referee::up;

class Duality {
 public:
  Duality(const ContactProblem& problem, const Slips& slips, std::vector<Index> equalities)
      : p_(problem), slips_(slips), equalities_(std::move(equalities)), orthogonal_(problem.size()) {
    for (const Index i : equalities_) {
      const auto split = orthogonal_.split(p_.unit_row(i));
      if (split.dependent) return;
      orthogonal_.append(split);
    }
    sigma_min_ = orthogonal_.sigma_min(p_, equalities_);
    Matrix rows(static_cast<Index>(equalities_.size()), p_.size());
    for (Index k = 0; k < rows.rows(); ++k) {
      const Index i = equalities_[at(k)];
      rows.row(k) = p_.whitened_row(i).template cast<double>() / p_.row_norm[i];
    }
    if (rows.rows() > 0) gram_.compute(rows * rows.transpose());
  }

  // Moves x onto the equality rows, by refinement; not where factors cannot tell them apart.
  void correct(ExtendedVector& x) const {
    if (equalities_.empty() || !(sigma_min_ > 0)) return;
    for (int round = 0; round < 4; ++round) {
      Vector slack(static_cast<Index>(equalities_.size()));
      bool rounding = true;
      for (Index k = 0; k < slack.size(); ++k) {
        const Index i = equalities_[at(k)];
        slack[k] = p_.slack(i, x).hi / p_.row_norm[i];
        rounding &= std::abs(slack[k]) * p_.row_norm[i] <= p_.slack_error(i, x);
      }
      if (rounding) return;
      const Vector push = gram_.solve(slack);
      if (!push.allFinite()) return;
      ExtendedVector lambda = ExtendedVector::Zero(p_.rows());
      for (Index k = 0; k < slack.size(); ++k) {
        const Index i = equalities_[at(k)];
        lambda[i] = -push[k] / p_.row_norm[i];
      }
      x += p_.motion_by(lambda, 1);  // the next round sees what it lacks
    }
  }

  // How far an exact solution of the equality rows is from x.
  double off(const ExtendedVector& x) const {
    if (equalities_.empty()) return 0;
    double sum = 0;
    for (const Index i : equalities_)
      sum = std::hypot(sum, (std::abs(p_.slack(i, x).hi) + p_.slack_error(i, x)) / p_.row_norm[i]);
    return sigma_min_ > 0 ? or_infinity(up(sum) / sigma_min_) : infinity;
  }

  // At least so far inside K*, for every sigma in its interval and every motion within `off` of x.
  double margin(Index c, const ExtendedVector& x, double off) const {
    const ContactRows& contact = p_.contacts[at(c)];
    double reach = p_.row_norm[contact.row];
    DoubleDouble s = p_.slack(contact.row, x);
    double error = p_.slack_error(contact.row, x);
    if (contact.rows() > 1) {
      s += DoubleDouble(contact.mu) * (slips_.sigma[c] - p_.slip(contact, x));
      error += contact.mu * (slips_.error[c] + p_.slip_error(contact, x)) +
               referee::rounding_of_few * (std::abs(s.hi) + contact.mu * (slips_.sigma[c].hi + p_.slip(contact, x).hi));
      for (Index t = 1; t < contact.rows(); ++t) reach += contact.mu * p_.row_norm[contact.row + t];
    }
    return s.hi - up(error + reach * off) - std::abs(s.hi) * referee::measured;
  }

  // C of bound_turn(), by x.
  double turn(const ExtendedVector& x) const {
    const double distance = off(x), size = p_.norm(x) + distance;
    double worst = 0;
    for (Index c = 0; c < std::ssize(p_.contacts); ++c) {
      const ContactRows& contact = p_.contacts[at(c)];
      if (contact.unit == 0 || contact.rows() == 1) continue;
      const double room = margin(c, x, distance);
      if (!(room > 0)) return infinity;
      double slip = 0;
      for (Index t = 1; t < contact.rows(); ++t) slip = std::hypot(slip, p_.row_norm[contact.row + t]);
      worst = std::max(worst, contact.mu * slip / room);
    }
    return or_infinity(up(worst * size * size / 4));
  }

  bool feasible(const ExtendedVector& x, bool strictly = false) const {
    const double distance = off(x);
    if (distance == infinity) return false;
    const auto inside = [&](Index c) {
      const double room = margin(c, x, distance);
      return strictly ? room > 0 : room >= 0;
    };
    for (Index c = 0; c < std::ssize(p_.contacts); ++c)
      if (p_.contacts[at(c)].unit == 0 ? !fixed_holds(c) : !inside(c)) return false;
    return true;
  }
  bool strictly_inside(const ExtendedVector& x) const { return feasible(x, true); }

  // J_i = 0: s = -c, as stored; sigma is |s_t| itself, or 0.
  bool fixed_holds(Index c) const {
    const ContactRows& contact = p_.contacts[at(c)];
    const bool lifted = slips_.error[c] > 0;
    if (contact.rows() == 1 || lifted) return p_.zero_row_holds(contact.row);
    const auto c_of = p_.stored_c.segment(contact.row, contact.rows());
    const double top = c_of.lpNorm<Eigen::Infinity>();
    if (top == 0) return true;
    DoubleDouble squares;
    for (Index t = 1; t < contact.rows(); ++t)
      squares += DoubleDouble(c_of[t]).scaled(-std::ilogb(top)) * DoubleDouble(c_of[t]).scaled(-std::ilogb(top));
    const DoubleDouble slip = DoubleDouble(contact.mu) * sqrt(squares),
                       s = -DoubleDouble(c_of[0]).scaled(-std::ilogb(top));
    return (s - slip).hi >= -referee::on_edge * (std::abs(s.hi) + slip.hi);  // on the edge: it holds
  }

  // The part of the way to `inner` that brings x inside, or infinity.
  double way_inside(const ExtendedVector& x, const ExtendedVector& inner) const {
    const double near = off(x), far = off(inner);
    if (near == infinity || far == infinity) return infinity;
    double way = 0;
    for (Index c = 0; c < std::ssize(p_.contacts); ++c) {
      if (p_.contacts[at(c)].unit == 0) continue;
      const double lack = -margin(c, x, near), room = margin(c, inner, far);
      if (lack <= 0) continue;
      if (!(room > 0)) return infinity;
      way = std::max(way, 2 * lack / (2 * lack + room));
    }
    return way;
  }

  // lambda moved into K, and the bound of (x, lambda); infinity where x is not inside.
  double bound(const ExtendedVector& x, ExtendedVector& lambda) const {
    if (!feasible(x)) return infinity;
    const double distance = off(x);
    DoubleDouble product;
    double rounding = 0;
    ExtendedVector pushes = ExtendedVector::Zero(lambda.size());
    for (Index c = 0; c < std::ssize(p_.contacts); ++c) {
      const ContactRows& contact = p_.contacts[at(c)];
      const Index row = contact.row;
      into_cone(contact, lambda);
      if (contact.unit == 0) continue;
      const DoubleDouble lifted = contact.rows() > 1
                                      ? p_.slack(contact.row, x) + DoubleDouble(contact.mu) * slips_.sigma[c]
                                      : p_.slack(contact.row, x);
      DoubleDouble part = lambda[row] * lifted;
      double sizes = std::abs(part.hi);
      rounding += lambda[row].hi * (p_.slack_error(contact.row, x) + contact.mu * slips_.error[c]);
      pushes[row] = lambda[row];
      for (Index t = 1; t < contact.rows(); ++t) {
        const Index k = row + t;
        const DoubleDouble term = lambda[k] * p_.slack(k, x);
        part += term;
        sizes += std::abs(term.hi);
        rounding += std::abs(lambda[k].hi) * p_.slack_error(k, x);
        pushes[k] = lambda[k];
      }
      product += part;
      rounding += referee::rounding_of_few * (sizes + contact.mu * lambda[row].hi * slips_.sigma[c].hi);
    }
    rounding += referee::rounding_of(std::ssize(p_.contacts)) * std::abs(product.hi);
    const double residual =
        p_.dual_norm(p_.force_residual(x, lambda)) * referee::widened_sum + p_.dual_norm(p_.force_error(x, lambda));
    double gap = (residual + distance) * (residual + distance) / 2 + std::max(0.0, product.hi) + rounding;
    if (distance > 0) {
      const ExtendedVector still = ExtendedVector::Zero(x.size());
      gap += distance * p_.dual_norm(p_.force_residual(still, pushes)) * referee::widened_sum;
    }
    return or_infinity(up(distance + std::sqrt(2 * gap)));
  }

 private:
  void into_cone(const ContactRows& contact, ExtendedVector& lambda) const {
    const Index row = contact.row;
    if (!(lambda[row].hi > 0) || contact.unit == 0) lambda[row] = 0;
    DoubleDouble tangential;
    for (Index t = 1; t <= contact.tangents; ++t) {
      DoubleDouble& l = lambda[row + t];
      if (t >= contact.rows() || lambda[row].hi == 0) l = 0;
      tangential += l * l;
    }
    tangential = sqrt(tangential);
    const DoubleDouble most = lambda[row] * contact.mu * DoubleDouble(1 - referee::unit_roundoff);
    if (tangential.hi < referee::underflow_of_squares) {  // squares may have vanished
      for (Index t = 1; t <= contact.tangents; ++t)
        if (std::abs(lambda[row + t].hi) * 2 > most.hi) lambda[row + t] = 0;
      return;
    }
    const DoubleDouble edge = lambda[row] * contact.mu;
    if ((edge - tangential).hi > referee::rounding_of_few * edge.hi) return;
    const DoubleDouble factor = edge / tangential * (DoubleDouble(1) - referee::rounding_of_few);
    for (Index t = 1; t < contact.rows(); ++t) lambda[row + t] *= factor;
  }

  const ContactProblem& p_;
  const Slips& slips_;
  std::vector<Index> equalities_;
  OrthogonalRows orthogonal_;
  double sigma_min_ = 0;
  Eigen::LDLT<Matrix> gram_;
};

}  // namespace

// A c that is nothing to the motion may vanish in its unit; one power of two of all c decides nothing.
std::vector<Index> independent_equalities(const ContactProblem& p, bool& contradictory) {
  int top = std::numeric_limits<int>::min();
  for (const Index i : p.equalities)
    if (p.stored_c[i] != 0) top = std::max(top, referee::exponent_of(p.stored_c[i]) - p.row_exponent[i]);
  Vector c = p.c;
  for (const Index i : p.equalities)
    if (p.stored_c[i] != 0) c[i] = std::ldexp(p.stored_c[i], -p.row_exponent[i] - top);
  const ExactBasis basis = exact_basis(p.J, c, p.equalities);
  contradictory = !basis.contradictory.empty();
  return basis.rows;
}

double bound_turn(const ContactProblem& p) {
  bool contradictory = p.fixed_contradiction;
  const std::vector<Index> equalities = independent_equalities(p, contradictory);
  if (contradictory || !p.exact) return infinity;
  Slips none(std::ssize(p.contacts));
  for (Index c = 0; c < none.error.size(); ++c)
    if (p.contacts[at(c)].unit == 0) none.error[c] = 1;  // nothing pushes there
  const Duality duality(p, none, equalities);
  double least = infinity;
  const auto consider = [&](ExtendedVector x) {
    duality.correct(x);
    if (duality.feasible(x)) least = std::min(least, duality.turn(x));
  };
  const auto method = equalities.empty() ? interior_point<DoubleDouble> : interior_point<double>;
  for (const InteriorAnswer& iterate : method(p, equalities, &none.sigma, {.target = referee::interior_target_rough}))
    consider(iterate.x);
  return least;
}

ConvexBound bound_convex(const ContactProblem& p, const Slips& slips, const ModePoint* guess, double enough) {
  ConvexBound best;
  bool contradictory = p.fixed_contradiction;
  const std::vector<Index> equalities = contradictory ? std::vector<Index>{} : independent_equalities(p, contradictory);
  const ExtendedVector& sigma = slips.sigma;
  const Duality duality(p, slips, equalities);
  for (Index c = 0; c < std::ssize(p.contacts); ++c)
    if (p.contacts[at(c)].unit == 0 && !duality.fixed_holds(c)) contradictory = true;
  if (contradictory) {
    best.rows = ConvexBound::Rows::infeasible;
    return best;
  }
  if (!p.exact) return best;

  const bool jointed = !equalities.empty();
  std::vector<InteriorAnswer> inner;
  const auto correct_from = [&](std::size_t first) {
    for (InteriorAnswer& iterate : inner | std::views::drop(first)) {
      duality.correct(iterate.x);
      best.interior |= duality.strictly_inside(iterate.x);
    }
  };
  const auto consider = [&](ModePoint point) {
    const auto take = [&](ExtendedVector x) {
      ExtendedVector lambda = point.lambda;
      const double upper = duality.bound(x, lambda);
      if (!(upper < best.upper)) return;
      best.upper = upper;
      best.x = std::move(x);
      best.lambda = std::move(lambda);
      best.modes = point.modes;
      best.rows = ConvexBound::Rows::feasible;
    };
    duality.correct(point.x);
    if (duality.feasible(point.x)) return take(point.x);
    double cost = infinity, part = 0;
    const InteriorAnswer* target = nullptr;
    for (const InteriorAnswer& iterate : inner) {
      const double way = duality.way_inside(point.x, iterate.x);
      if (way < 1 && way * (iterate.complementarity + referee::inner_cost) < cost) {
        cost = way * (iterate.complementarity + referee::inner_cost);
        part = way;
        target = &iterate;
      }
    }
    if (!target) return;
    ExtendedVector x = point.x;
    x += DoubleDouble(part) * (target->x - x);
    take(std::move(x));
  };
  const auto polished = [&](ModePoint point) {
    polish(p, point, &sigma);
    consider(std::move(point));
  };
  // A guess of modes that are right needs a point inside, and no good one.
  if (guess && p.rows() <= referee::polished_rows) {
    inner = interior_point<double>(p, equalities, &sigma, {.target = referee::interior_target_rough});
    correct_from(0);
    polished(*guess);
    if (best.upper <= enough) return best;
  }
  const std::size_t corrected = inner.size();
  // Without joints, in double-double at once; with them first in double.
  std::ranges::move(
      jointed ? interior_point<double>(p, equalities, &sigma)
              : interior_point<DoubleDouble>(p, equalities, &sigma, {.target = referee::interior_target_extended}),
      std::back_inserter(inner));
  correct_from(corrected);
  // Iterates may come to the answer along the outside of a cone: then a point inside is looked for.
  for (const double inward : referee::interior_inward) {
    if (best.interior || jointed) break;
    for (InteriorAnswer& iterate : interior_point<DoubleDouble>(
             p, equalities, &sigma, {.target = referee::interior_target_inside, .inward = inward}))
      if (duality.strictly_inside(iterate.x)) {
        best.interior = true;
        iterate.complementarity += inward;
        inner.insert(inner.begin(), std::move(iterate));
      }
  }
  if (!jointed && !inner.empty()) consider(inner.back());
  if (!jointed && p.rows() > referee::polished_rows && best.upper <= referee::good_enough) return best;
  if (guess && best.upper > enough) polished(*guess);
  const auto take_both = [&](const InteriorAnswer& answer) {
    polished(answer);
    if (jointed) consider(answer);
  };
  if (best.upper > enough && !inner.empty()) take_both(inner.back());
  if (best.upper > enough && jointed && p.rows() <= referee::extended_rows)
    if (const auto finer =
            interior_point<DoubleDouble>(p, equalities, &sigma, {.target = referee::interior_target_extended});
        !finer.empty())
      take_both(finer.back());
  return best;
}

}  // namespace zwang
