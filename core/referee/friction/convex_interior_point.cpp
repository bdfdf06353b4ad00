#include <zwang/core/referee/friction/convex_interior_point.h>

#include <algorithm>
#include <cmath>

namespace zwang {

using namespace lorentz_cone;

namespace {

constexpr int most_stalled = 12;

}  // namespace

ConvexInteriorPoint::ConvexInteriorPoint(const ContactProblem& p, const ExtendedVector& sigma, double inward)
    : p_(p), normal_(p.size()) {
  for (std::size_t c = 0; c < p.contacts.size(); ++c) {
    const ContactRows& contact = p.contacts[c];
    if (contact.unit == 0) continue;
    cones_.push_back(c);
    Block unit(contact.rows()), q(contact.rows());
    for (Index t = 0; t < contact.rows(); ++t) {
      unit[t] = t == 0 && contact.rows() > 1 ? DoubleDouble(1) / contact.mu : DoubleDouble(1);
      q[t] = -(p.h[static_cast<std::size_t>(contact.row + t)] * unit[t]);
    }
    if (contact.rows() > 1) q[0] += sigma[c];
    q[0] -= unit[0] * (inward * contact.unit);
    unit_.push_back(std::move(unit));
    q_.push_back(std::move(q));
  }
}

ConvexInteriorPoint::Blocks ConvexInteriorPoint::slack(const ExtendedVector& x) const {
  Blocks s(cones_.size());
  for (std::size_t k = 0; k < cones_.size(); ++k) {
    s[k].resize(unit_[k].size());
    for (Index t = 0; t < s[k].size(); ++t) {
      DoubleDouble sum;
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p_.J, p_.contacts[cones_[k]].row + t); it;
           ++it)
        sum += DoubleDouble(it.value()) * x[static_cast<std::size_t>(it.col())];
      s[k][t] = sum * unit_[k][t];
    }
  }
  return s;
}

ExtendedVector ConvexInteriorPoint::multipliers(const Blocks& y) const {
  ExtendedVector lambda(static_cast<std::size_t>(p_.rows()));
  for (std::size_t k = 0; k < cones_.size(); ++k)
    for (Index t = 0; t < y[k].size(); ++t)
      lambda[static_cast<std::size_t>(p_.contacts[cones_[k]].row + t)] = y[k][t] * unit_[k][t];
  return lambda;
}

void ConvexInteriorPoint::form(const std::vector<NesterovTodd<DoubleDouble>>& scaling) {
  normal_.set_zero();
  for (Index j = 0; j < p_.size(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(p_.M, j); it; ++it)
      if (it.row() >= j) normal_.add(it.row(), j, it.value());
  ExtendedVector row(static_cast<std::size_t>(p_.size()));
  for (std::size_t k = 0; k < cones_.size(); ++k)
    for (Index a = 0; a < unit_[k].size(); ++a) {
      Block axis = Block::Zero(unit_[k].size());
      axis[a] = 1.0;
      const Block scaled = scaling[k].times(axis);  // row a of P
      std::ranges::fill(row, DoubleDouble());
      for (Index t = 0; t < scaled.size(); ++t) {
        const DoubleDouble factor = scaled[t] * unit_[k][t];
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p_.J, p_.contacts[cones_[k]].row + t); it;
             ++it)
          row[static_cast<std::size_t>(it.col())] += factor * it.value();
      }
      normal_.add_square(row);
    }
}

DoubleDouble ConvexInteriorPoint::longest(const Blocks& at, const Blocks& step) const {
  DoubleDouble least = 1e6;
  for (std::size_t k = 0; k < at.size(); ++k) least = std::min(least, longest_step<DoubleDouble>(at[k], step[k]));
  return least;
}

InteriorAnswer ConvexInteriorPoint::answer(const ExtendedVector& x, const Blocks& y, const Blocks& w) const {
  InteriorAnswer out;
  out.x = x;
  out.lambda = multipliers(y);
  out.modes.assign(p_.contacts.size(), ContactMode::open);
  for (std::size_t k = 0; k < cones_.size(); ++k) out.modes[cones_[k]] = mode_of<DoubleDouble>(y[k], w[k]);
  return out;
}

std::vector<InteriorAnswer> ConvexInteriorPoint::solve(const InteriorOptions& options) {
  const std::size_t count = cones_.size();
  ExtendedVector x(static_cast<std::size_t>(p_.size())), dx;
  Blocks y(count), w(count), dy(count), dw(count), target(count), lam(count);
  for (std::size_t k = 0; k < count; ++k) {
    const ContactRows& contact = p_.contacts[cones_[k]];
    const double mu = contact.rows() > 1 ? contact.mu : 1;
    y[k] = w[k] = Block::Zero(contact.rows());
    y[k][0] = options.start * std::min(1.0, mu);
    w[k][0] = options.start * std::max(1.0, 1 / mu);
  }
  std::vector<InteriorAnswer> out;
  double best = std::numeric_limits<double>::infinity();
  int stalled = 0;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    Blocks r = slack(x);  // w - (J x + q)
    const ExtendedVector force = p_.force_residual(x, multipliers(y));
    DoubleDouble product;
    double size = 0;
    for (std::size_t k = 0; k < count; ++k) {
      r[k] = w[k] - r[k] - q_[k];
      product += y[k].dot(w[k]);
      size += r[k].squaredNorm().hi;
    }
    for (const DoubleDouble& f : force) size += f.hi * f.hi;
    const DoubleDouble mean = product / std::max(1.0, static_cast<double>(count));
    const double merit = std::max(mean.hi, 0.0) + size;
    if (!std::isfinite(merit)) break;
    stalled = merit < best * 0.9 ? 0 : stalled + 1;
    if (merit < best || out.empty()) {
      best = std::min(best, merit);
      out.push_back(answer(x, y, w));
      out.back().complementarity = mean.hi;
      out.back().residual = std::sqrt(size);
      out.back().converged = mean.hi <= options.target && size <= options.target;
      if (out.back().converged) break;
    }
    if (stalled > most_stalled) break;

    std::vector<NesterovTodd<DoubleDouble>> scaling;
    for (std::size_t k = 0; k < count; ++k) {
      scaling.emplace_back(y[k], w[k]);
      lam[k] = scaling[k].times(w[k]);
      target[k] = -lam[k];
    }
    form(scaling);
    if (!normal_.factorize()) break;
    // M dx - J'dy = -force, dw = J dx - r, P dw + P^-1 dy = target.
    const auto direction = [&] {
      Blocks push(count);
      for (std::size_t k = 0; k < count; ++k) push[k] = scaling[k].times(target[k] + scaling[k].times(r[k]));
      const ExtendedVector still(x.size());
      dx = p_.force_residual(still, multipliers(push));
      for (std::size_t j = 0; j < dx.size(); ++j) dx[j] = -dx[j] - force[j];
      normal_.solve(dx);
      dw = slack(dx);
      for (std::size_t k = 0; k < count; ++k) {
        dw[k] -= r[k];
        dy[k] = scaling[k].times(target[k] - scaling[k].times(dw[k]));
      }
    };
    const auto most = [&] { return std::min(longest(y, dy), longest(w, dw)); };
    direction();
    const DoubleDouble left = DoubleDouble(1) - std::min(DoubleDouble(1), most());
    const DoubleDouble centre = std::max(left * left * left, DoubleDouble(1e-4));
    for (std::size_t k = 0; k < count; ++k) {
      Block wanted = -jordan<DoubleDouble>(lam[k], lam[k]) -
                     jordan<DoubleDouble>(scaling[k].divide(dy[k]), scaling[k].times(dw[k]));
      wanted[0] += centre * mean;
      target[k] = jordan_divide<DoubleDouble>(lam[k], wanted);
    }
    direction();
    const DoubleDouble step = std::min(DoubleDouble(1), DoubleDouble(0.98) * most());
    if (!(step.hi > 0) || !std::isfinite(step.hi)) break;
    for (std::size_t k = 0; k < count; ++k) {
      y[k] += step * dy[k];
      w[k] += step * dw[k];
    }
    for (std::size_t j = 0; j < x.size(); ++j) x[j] += step * dx[j];
  }
  std::ranges::stable_sort(out, [](const InteriorAnswer& a, const InteriorAnswer& b) {
    return a.complementarity + a.residual * a.residual > b.complementarity + b.residual * b.residual;
  });
  return out;
}

}  // namespace zwang
