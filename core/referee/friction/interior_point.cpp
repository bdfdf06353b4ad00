#include <zwang/core/referee/friction/interior_point.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include <zwang/core/referee/friction/lorentz_cone.h>

namespace zwang {

using namespace lorentz_cone;

RefereeInteriorPoint::RefereeInteriorPoint(const ContactProblem& p, std::vector<Index> equalities)
    : p_(&p), rows_(std::move(equalities)), equalities_(static_cast<Index>(rows_.size())) {
  unit_.assign(rows_.size(), 1.0);
  for (std::size_t c = 0; c < p.contacts.size(); ++c) {
    const ContactRows& contact = p.contacts[c];
    if (contact.unit == 0) continue;
    const double mu = contact.rows() > 1 ? contact.mu : 1;
    cones_.push_back({static_cast<Index>(rows_.size()), contact.rows(), c, mu});
    for (Index t = 0; t < contact.rows(); ++t) {
      rows_.push_back(contact.row + t);
      unit_.push_back(DoubleDouble(1) / (t == 0 ? mu : 1));
    }
  }
  const auto m = static_cast<Index>(rows_.size());
  MatrixX<FactorReal> G(p.size(), m);
  for (Index k = 0; k < m; ++k) {
    const Index row = rows_[static_cast<std::size_t>(k)];
    G.col(k) = p.whitened_row(row) * static_cast<FactorReal>(unit_[static_cast<std::size_t>(k)]);
  }
  W_ = G.transpose() * G;
}

template <class Real>
MatrixX<Real> RefereeInteriorPoint::matrix() const {
  if constexpr (std::is_same_v<Real, double>) return W_.template cast<double>();
  if constexpr (std::is_same_v<Real, DoubleDouble>) {
    const auto m = static_cast<Index>(rows_.size());
    MatrixX<DoubleDouble> W(m, m);
    for (Index k = 0; k < m; ++k) {
      ExtendedVector push(static_cast<std::size_t>(p_->rows()));
      push[static_cast<std::size_t>(rows_[static_cast<std::size_t>(k)])] = unit_[static_cast<std::size_t>(k)];
      const ExtendedVector x = p_->motion_by(push);
      for (Index i = 0; i < m; ++i) {
        DoubleDouble sum;
        for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p_->J, rows_[static_cast<std::size_t>(i)]);
             it; ++it)
          sum += DoubleDouble(it.value()) * x[static_cast<std::size_t>(it.col())];
        W(i, k) = sum * unit_[static_cast<std::size_t>(i)];
      }
    }
    return W;
  }
  if constexpr (std::is_same_v<Real, FactorReal>) return W_;
}

template <class Real>
InteriorAnswer RefereeInteriorPoint::answer(const VectorX<Real>& y, const VectorX<Real>& w) const {
  InteriorAnswer out;
  out.lambda.resize(static_cast<std::size_t>(p_->rows()));
  for (Index k = 0; k < y.size(); ++k)
    out.lambda[static_cast<std::size_t>(rows_[static_cast<std::size_t>(k)])] =
        double_double(y[k]) * unit_[static_cast<std::size_t>(k)];
  out.x = p_->motion_by(out.lambda);
  out.modes.assign(p_->contacts.size(), ContactMode::open);
  for (const Cone& cone : cones_) {
    const VectorX<Real> a = y.segment(cone.first, cone.rows), b = w.segment(cone.first, cone.rows);
    out.modes[cone.contact] = mode_of(a, b);
  }
  return out;
}

template <class Real>
std::vector<InteriorAnswer> RefereeInteriorPoint::solve(const ExtendedVector* sigma,
                                                        const InteriorOptions& options) const {
  using std::abs;
  using std::sqrt;
  const Index m = static_cast<Index>(rows_.size());
  const MatrixX<Real> W = matrix<Real>();
  VectorX<Real> q(m);
  for (Index k = 0; k < m; ++k)
    q[k] = -static_cast<Real>(p_->h[static_cast<std::size_t>(rows_[static_cast<std::size_t>(k)])] *
                              unit_[static_cast<std::size_t>(k)]);
  VectorX<Real> y = VectorX<Real>::Zero(m), w = VectorX<Real>::Zero(m);
  for (const Cone& cone : cones_) {
    y[cone.first] = Real(options.start * std::min(1.0, cone.mu));
    w[cone.first] = Real(options.start * std::max(1.0, 1 / cone.mu));
  }
  const auto slip = [&](const Cone& cone, const VectorX<Real>& at) -> Real {
    if (cone.rows == 1) return Real(0);
    if (sigma) return static_cast<Real>((*sigma)[cone.contact]);
    return at.segment(cone.first + 1, cone.rows - 1).norm();
  };
  const auto lift = [&](const VectorX<Real>& at) {
    VectorX<Real> r = at - W * y - q;
    for (const Cone& cone : cones_) r[cone.first] -= slip(cone, at);
    return r;
  };
  std::vector<InteriorAnswer> out;
  double best = std::numeric_limits<double>::infinity();
  int stalled = 0;
  const auto count = std::max<double>(1, static_cast<double>(cones_.size()));
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const VectorX<Real> r = lift(w);
    Real product = Real(0);
    for (const Cone& cone : cones_) product += y.segment(cone.first, cone.rows).dot(w.segment(cone.first, cone.rows));
    const Real mean = product / Real(count);
    const double merit = std::max(static_cast<double>(mean), 0.0) + static_cast<double>(r.squaredNorm());
    if (!std::isfinite(merit)) break;
    const double size = static_cast<double>(r.norm());
    const bool better = merit < best * 0.9;
    stalled = better ? 0 : stalled + 1;
    if (merit < best || out.empty()) {
      best = std::min(best, merit);
      InteriorAnswer now = answer(y, w);
      now.complementarity = static_cast<double>(mean);
      now.residual = size;
      now.converged = now.complementarity <= options.target && size * size <= options.target;
      if (!options.keep_iterates) out.clear();
      out.push_back(std::move(now));
      if (out.back().converged) break;
    }
    if (stalled > 12) break;

    std::vector<NesterovTodd<Real>> scaling;
    std::vector<VectorX<Real>> lam;
    MatrixX<Real> A = W;
    VectorX<Real> lifted = r, turn = VectorX<Real>::Zero(m);  // tau of each cone
    for (const Cone& cone : cones_) {
      const VectorX<Real> a = y.segment(cone.first, cone.rows), b = w.segment(cone.first, cone.rows);
      scaling.emplace_back(a, b);
      lam.push_back(scaling.back().times(b));
      if (!sigma && cone.rows > 1) {
        const VectorX<Real> t = b.tail(cone.rows - 1);
        const Real norm = t.norm();
        if (norm > Real(0))
          for (Index k = 1; k < cone.rows; ++k) {
            const Real tau = turn[cone.first + k] = t[k - 1] / norm;
            A.row(cone.first) += tau * W.row(cone.first + k);
            lifted[cone.first] += tau * r[cone.first + k];
          }
      }
      A.block(cone.first, cone.first, cone.rows, cone.rows) += scaling.back().inverse_square();
    }
    const Eigen::PartialPivLU<MatrixX<Real>> lu(A);
    VectorX<Real> dy(m), dw(m);
    const auto direction = [&](const std::vector<VectorX<Real>>& target) {
      VectorX<Real> right = lifted;
      for (std::size_t k = 0; k < cones_.size(); ++k)
        right.segment(cones_[k].first, cones_[k].rows) += scaling[k].divide(target[k]);
      dy = lu.solve(right);
      dy += lu.solve(right - A * dy);
      // From the equations, not from the scaling: w then stays J x - h up to the rounding of W.
      const VectorX<Real> moved = W * dy - r;
      dw.setZero();
      for (const Cone& cone : cones_) {
        dw.segment(cone.first, cone.rows) = moved.segment(cone.first, cone.rows);
        for (Index k = 1; k < cone.rows; ++k) dw[cone.first] += turn[cone.first + k] * moved[cone.first + k];
      }
    };
    const auto longest = [&] {
      Real t = Real(1e6);
      for (const Cone& cone : cones_)
        for (const auto& [at, step] : {std::pair(&y, &dy), std::pair(&w, &dw)})
          t = std::min<Real>(
              t, longest_step<Real>(at->segment(cone.first, cone.rows), step->segment(cone.first, cone.rows)));
      return t;
    };
    std::vector<VectorX<Real>> target;
    for (const VectorX<Real>& l : lam) target.push_back(-l);
    direction(target);
    const Real affine = std::min(Real(1), longest());
    const Real left = Real(1) - affine;
    const Real centre = std::max(left * left * left, Real(1e-4));
    for (std::size_t k = 0; k < cones_.size(); ++k) {
      const Cone& cone = cones_[k];
      const VectorX<Real> part = dy.segment(cone.first, cone.rows), other = dw.segment(cone.first, cone.rows);
      VectorX<Real> wanted =
          -jordan<Real>(lam[k], lam[k]) - jordan<Real>(scaling[k].divide(part), scaling[k].times(other));
      wanted[0] += centre * mean;
      target[k] = jordan_divide<Real>(lam[k], wanted);
    }
    direction(target);
    Real step = std::min(Real(1), Real(0.98) * longest());
    if (!(step > Real(0)) || !dy.allFinite() || !dw.allFinite()) break;
    y += step * dy;
    w += step * dw;
  }
  std::stable_sort(out.begin(), out.end(), [](const InteriorAnswer& a, const InteriorAnswer& b) {
    return a.complementarity + a.residual * a.residual > b.complementarity + b.residual * b.residual;
  });
  return out;
}

template std::vector<InteriorAnswer> RefereeInteriorPoint::solve<double>(const ExtendedVector*,
                                                                         const InteriorOptions&) const;
template std::vector<InteriorAnswer> RefereeInteriorPoint::solve<DoubleDouble>(const ExtendedVector*,
                                                                               const InteriorOptions&) const;
#ifndef ZWANG_NO_X87
template std::vector<InteriorAnswer> RefereeInteriorPoint::solve<long double>(const ExtendedVector*,
                                                                              const InteriorOptions&) const;
#endif

}  // namespace zwang
