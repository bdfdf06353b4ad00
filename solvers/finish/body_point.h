#pragma once

#include <span>

#include <zwang/solvers/form/body_rows.h>

namespace zwang {

// (z, lambda) of jointed bodies as sums of two doubles, and what they leave of the problem's own M, z_u, J, c: the
// residuals that a refinement in double needs to be right beyond double.
//
// Products are split without error and their errors summed beside the sums (Dot2 of Ogita, Rump & Oishi 2005), six
// unknowns of a body at a time: 106 bits. Tried: x87's long double, one entry after the other, 64 bits in thrice the
// time.
class BodyPoint {
 public:
  using Motion = BodyRows::Motion;

  // z = z_u + 2^exponent L^-T y and lambda = 0; then z moves on by 2^exponent L^-T step.
  void begin(const BodyRows& rows, const Motion& y);
  void move(const BodyRows& rows, const Motion& step);
  // Adds multipliers of the unit rows listed, in units of 2^exponent, to the problem's own.
  void push(const BodyRows& rows, std::span<const Index> listed, const double* unit);

  // What is left of the KKT conditions over the rows listed, in units of 2^exponent: their violations (below), and
  // rho = L^-1 (M (z_u - z) + J'lambda), in three parts: the first term, rows, the whole whitened.
  void begin_force(const BodyRows& rows);
  void add_rows(const BodyRows& rows, std::span<const Index> listed, double* out);
  void whiten_force(const BodyRows& rows, Motion& rho) const;
  // (c_i - J_i z) / |J_i|_(M^-1), likewise, of the rows listed.
  void violations(const BodyRows& rows, std::span<const Index> listed, double* out) const;
  // (|c_i| + |J_i| |z|) / |J_i|_(M^-1), likewise: what a violation is made of.
  double terms(const BodyRows& rows, Index i) const;

  // As doubles, by the problem's unknowns and rows.
  void write(const BodyRows& rows, Vector& z, Vector& lambda) const;

 private:
  using Lanes = BodyRows::Lanes;

  Motion z_, z_rest_, force_, force_rest_;
  Vector lambda_, lambda_rest_;  // of BodyRows
  double unit_ = 1;              // 2^exponent
};

}  // namespace zwang
