#pragma once

#include <algorithm>
#include <cmath>

#include <zwang/core/problem/types.h>
#include <zwang/core/referee/friction/mode_system.h>
#include <zwang/core/referee/tolerances.h>

// The Lorentz cone x_0 >= |x_t| and its Jordan algebra (Alizadeh & Goldfarb 2003, Math. Program. 95), in any scalar, on
// vectors of any length; one entry: a ray.
namespace zwang::lorentz_cone {

// The product x o y, and x \ y with x o (x \ y) = y.
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

// The largest t with x + t dx in the cone, up to a bound that stands for all.
template <class Real>
Real longest_step(const VectorX<Real>& x, const VectorX<Real>& dx) {
  using std::sqrt;
  Real least = Real(referee::interior_reach);
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
struct NesterovTodd {
  Real eta;
  VectorX<Real> v;  // unit: v_0^2 - |v_t|^2 = 1

  NesterovTodd(const VectorX<Real>& y, const VectorX<Real>& w) {
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
  // P^2 = eta^2 (2 v v' - J), J = diag(1, -1, -1)
  MatrixX<Real> square() const {
    MatrixX<Real> out = Real(2) * v * v.transpose();
    out(0, 0) -= Real(1);
    for (Index k = 1; k < v.size(); ++k) out(k, k) += Real(1);
    return out * (eta * eta);
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

// What a contact does, by the eigenvalues of both sides of a pair inside the cones.
template <class Real>
ContactMode mode_of(const VectorX<Real>& y, const VectorX<Real>& w) {
  const Index k = y.size() - 1;
  if (k == 0) return y[0] > w[0] ? ContactMode::stick : ContactMode::open;
  const Real tail_y = y.tail(k).norm(), tail_w = w.tail(k).norm();
  if (y[0] + tail_y < w[0] - tail_w) return ContactMode::open;
  return w[0] + tail_w < y[0] - tail_y ? ContactMode::stick : ContactMode::slide;
}

}  // namespace zwang::lorentz_cone
