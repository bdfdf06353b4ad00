#pragma once

#include <algorithm>
#include <cmath>

#include <zwang/core/problem/law.h>
#include <zwang/solvers/law/second_order_cone.h>

namespace zwang {

// A law of cones on one contact, as solvers see it: s and y are three numbers each, of the rows (N / mu, T1, T2) that
// ConeProgram states, and L = {x_0 >= |x_t|}.
//
//   L ∋ s + lift |s_t| e_0 ⊥ y ∈ L
//
// A contact is then in one of three modes, with u = -s_t / |s_t| where it slides:
//
//   open   y = 0        stick   s = 0        slide   y = a (1, u),  (1, (1 - lift) u)'s = 0
struct ConeLaw {
  double lift = 0;  // 0: the convex law; 1: Coulomb's. Between, what slides opens at (1 - lift) |s_t|

  static constexpr ConeLaw of(Law law) { return {lift_of(law)}; }
  constexpr bool lifts() const { return lift > 0; }
  constexpr double opening() const { return 1 - lift; }

  // What slip adds to s_0.
  double shift(const double* s) const { return lifts() ? lift * second_order_cone::tangential(s) : 0; }

  // What is wrong with (s, y), in units of N and T, where the cone of forces has the coefficient mu.
  struct Residual {
    double natural;  // the largest entry of l - P_K(l - s) with the law's shift, or of what s violates
    double gap;      // y's with the violations charged
  };
  Residual residual(const double* y, const double* s, double mu) const;

  enum class Mode : char { open, stick, slide };
  struct Slide {
    double u1, u2, size, pressure;  // u and size of p_t = y_t - s_t; the normal multiplier
  };
  // At which mode y - s is, and where it slides. `weight`: of the slip, where opening() is 0.
  Mode mode(const double* y, const double* s, Slide& slide, double weight = 1) const;
  // The step of Newton's method on the equations of a mode, y_new = next - D ds, D by columns; with a proximal term
  // 1 / softness in y, in its normal entry tilt^2 times that, across a slip 1 / softness_across. At softness 1 and tilt
  // 1, D is the derivative of y - s -> (0, y - s, a (1, u)), the answer of the modes. Of an open contact both are 0, as
  // they are passed.
  void linearize(Mode mode, const Slide& slide, double softness, double softness_across, double tilt, const double* y,
                 const double* s, double* D, double* next) const;
};

inline ConeLaw::Residual ConeLaw::residual(const double* y, const double* s, double mu) const {
  const double slip = std::hypot(s[1], s[2]), l = y[0] / mu, shifted = mu * (s[0] + lift * slip);
  const double a = l - shifted, b = y[1] - s[1], c = y[2] - s[2], t = std::sqrt(b * b + c * c);
  double normal = a, share = 1;
  if (t > mu * a) {
    normal = mu * t <= -a ? 0 : (a + mu * t) / (1 + mu * mu);
    share = normal > 0 ? mu * normal / t : 0;
  }
  // Where l is so large that l - s is l, the residual is blind: the violation stands beside it.
  const double violated = std::max(0.0, mu * (opening() * slip) - mu * s[0]);
  const double pull = std::max(0.0, std::hypot(y[1], y[2]) - mu * l);
  return {std::max({0.0, std::abs(l - normal), std::abs(y[1] - share * b), std::abs(y[2] - share * c), violated}),
          l * shifted + y[1] * s[1] + y[2] * s[2] + 2 * std::abs(l) * violated + 2 * pull * (slip + std::abs(shifted))};
}

inline ConeLaw::Mode ConeLaw::mode(const double* y, const double* s, Slide& slide, double weight) const {
  const double p0 = y[0] - s[0], p1 = y[1] - weight * s[1], p2 = y[2] - weight * s[2];
  const double size = std::sqrt(p1 * p1 + p2 * p2);
  if (p0 + opening() * size <= 0) return Mode::open;
  if (size <= p0) return Mode::stick;
  slide = {p1 / size, p2 / size, size, (p0 + opening() * size) / (1 + opening())};
  if (weight > 1) slide.size = slide.pressure + (size - slide.pressure) / weight;  // of a slip as it is
  return Mode::slide;
}

inline void ConeLaw::linearize(Mode mode, const Slide& slide, double softness, double softness_across, double tilt,
                               const double* y, const double* s, double* D, double* next) const {
  const double hard = 1 / softness, normal_hard = hard * tilt * tilt;  // of the rows T, and N / mu
  if (mode == Mode::stick) {
    D[0] = normal_hard;
    D[4] = D[8] = hard;
    for (int i = 0; i < 3; ++i) next[i] = y[i] - D[4 * i] * s[i];
  } else if (mode == Mode::slide) {
    const auto [u1, u2, size, pressure] = slide;
    const double share = pressure / size;  // < 1: |s_t| = size - pressure
    const double bend = std::min(1 / softness_across, share / std::max(softness_across, 1 - share));
    const double P11 = bend * (1 - u1 * u1), P12 = -bend * u1 * u2, P22 = bend * (1 - u2 * u2);
    // D's part of the row that holds, which is soft where a row T is part of it.
    const double n0 = (opening() > 0 ? std::min(hard, normal_hard) : normal_hard) / (1 + opening());
    const double n1 = opening() * n0 * u1, n2 = opening() * n0 * u2;
    const double normal = pressure - (n0 * s[0] + n1 * s[1] + n2 * s[2]);
    next[0] = normal;
    next[1] = u1 * normal - (P11 * s[1] + P12 * s[2]);
    next[2] = u2 * normal - (P12 * s[1] + P22 * s[2]);
    D[0] = n0;
    D[3] = n1;
    D[6] = n2;
    D[1] = u1 * n0;
    D[4] = u1 * n1 + P11;
    D[7] = u1 * n2 + P12;
    D[2] = u2 * n0;
    D[5] = u2 * n1 + P12;
    D[8] = u2 * n2 + P22;
  }
}

}  // namespace zwang
