#include <zwang/core/referee/friction/interior_point.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace zwang {
namespace {

// Lorentz cone: product x o y, and x \ y with x o (x \ y) = y.
template <class Real>
VectorX<Real> jordan(const VectorX<Real>& x, const VectorX<Real>& y) {
  VectorX<Real> out(x.size());
  out[0] = x.dot(y);
  for (Index k = 1; k < x.size(); ++k) out[k] = x[0] * y[k] + y[0] * x[k];
  return out;
}

template <class Real>
Real determinant(const VectorX<Real>& x) {
  using std::sqrt;
  if (x.size() == 1) return x[0] * x[0];
  const Real tail = x.tail(x.size() - 1).norm();
  return (x[0] - tail) * (x[0] + tail);
}

template <class Real>
VectorX<Real> jordan_divide(const VectorX<Real>& x, const VectorX<Real>& y) {
  VectorX<Real> out(x.size());
  if (x.size() == 1) {
    out[0] = y[0] / x[0];
    return out;
  }
  const Index k = x.size() - 1;
  const Real det = determinant(x), dot = x.tail(k).dot(y.tail(k));
  out[0] = (x[0] * y[0] - dot) / det;
  out.tail(k) = (y.tail(k) - out[0] * x.tail(k)) / x[0];
  return out;
}

// The largest t <= 1 / 0.99.. with x + t dx in the cone.
template <class Real>
Real longest_step(const VectorX<Real>& x, const VectorX<Real>& dx) {
  using std::sqrt;
  Real least = Real(1e6);
  if (x.size() == 1) return dx[0] < Real(0) ? -x[0] / dx[0] : least;
  const Index k = x.size() - 1;
  const Real a = dx[0] * dx[0] - dx.tail(k).squaredNorm();
  const Real b = x[0] * dx[0] - x.tail(k).dot(dx.tail(k));
  const Real c = determinant(x);
  if (dx[0] < Real(0)) least = std::min(least, -x[0] / dx[0]);
  const Real disc = b * b - a * c;
  if (disc < Real(0)) return least;
  const Real root = sqrt(disc);
  // Roots of a t^2 + 2 b t + c without cancellation.
  const Real h = b > Real(0) ? -b - root : -b + root;
  for (const Real t : {a != Real(0) ? h / a : Real(-1), h != Real(0) ? c / h : Real(-1)})
    if (t > Real(0)) least = std::min(least, t);
  return least;
}

// Nesterov and Todd's P of a pair: P w = P^-1 y.
template <class Real>
struct Scaling {
  Real eta;
  VectorX<Real> v;  // unit: v_0^2 - |v_t|^2 = 1

  Scaling(const VectorX<Real>& y, const VectorX<Real>& w) {
    using std::sqrt;
    const Real dy = sqrt(determinant(y)), dw = sqrt(determinant(w));
    eta = sqrt(dy / dw);
    v = y / dy;
    v[0] += w[0] / dw;
    for (Index k = 1; k < v.size(); ++k) v[k] -= w[k] / dw;
    const Real dot = (y.dot(w) / dy) / dw;
    v /= sqrt(Real(2) * (Real(1) + dot));
  }
  VectorX<Real> times(const VectorX<Real>& x) const { return apply(x, Real(1)) * eta; }
  VectorX<Real> divide(const VectorX<Real>& x) const { return apply(x, Real(-1)) / eta; }
  // P^-2 = (2 (Jv)(Jv)' - J) / eta^2
  MatrixX<Real> inverse_square() const {
    VectorX<Real> u = -v;
    u[0] = v[0];
    MatrixX<Real> out = Real(2) * u * u.transpose();
    out(0, 0) -= Real(1);
    for (Index k = 1; k < v.size(); ++k) out(k, k) += Real(1);
    return out / (eta * eta);
  }

 private:
  VectorX<Real> apply(const VectorX<Real>& x, const Real& sign) const {
    VectorX<Real> out(x.size());
    const Index k = x.size() - 1;
    const Real dot = k > 0 ? Real(v.tail(k).dot(x.tail(k))) : Real(0);
    out[0] = v[0] * x[0] + sign * dot;
    if (k > 0) out.tail(k) = x.tail(k) + (sign * x[0] + dot / (Real(1) + v[0])) * v.tail(k);
    return out;
  }
};

}  // namespace

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
    ContactMode& mode = out.modes[cone.contact];
    if (cone.rows == 1) {
      mode = a[0] > b[0] ? ContactMode::stick : ContactMode::open;
      continue;
    }
    const Real ta = a.tail(cone.rows - 1).norm(), tb = b.tail(cone.rows - 1).norm();
    const Real least_a = a[0] - ta, least_b = b[0] - tb, top_a = a[0] + ta, top_b = b[0] + tb;
    mode = top_a < least_b ? ContactMode::open : top_b < least_a ? ContactMode::stick : ContactMode::slide;
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

    std::vector<Scaling<Real>> scaling;
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
