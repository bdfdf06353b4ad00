#pragma once

#include <vector>

#include <zwang/core/problem/types.h>

namespace zwang {

// The rows G of a cone program and the matrix that its methods factorize: three rows a cone, then the single rows.
// All vectors over rows have 3 cones + rays entries; those over unknowns have size() entries or more, the rest zero.
class ConeFace {
 public:
  virtual ~ConeFace() = default;

  virtual Index unknowns() const = 0;                        // length of a vector over the unknowns
  virtual void slack(const Vector& v, Vector& s) const = 0;  // s = G v
  virtual void force(const Vector& l, Vector& f) const = 0;  // f = G'l
  virtual void mass(const Vector& v, Vector& f) const = 0;   // f = M v
  virtual bool takes_unsymmetric() const = 0;
  // M + G'D G, D of 3 x 3 blocks (by columns, nine numbers a cone) and one number a single row. Without `symmetric` the
  // blocks need not be. False on a breakdown.
  virtual bool factorize(const std::vector<double>& D, const Vector& ray_weight, bool symmetric) = 0;
  virtual void solve(Vector& x) = 0;

  // For methods that move one row at a time, after divide_rows(), which is false where M ties many unknowns to each
  // other: g_r v, v += M^-1 g_r' l, and g_r M^-1 g_q' of two rows of a cone.
  virtual bool divide_rows() = 0;
  virtual double along(Index r, const Vector& v) const = 0;
  virtual void push(Index r, double l, Vector& v) const = 0;
  virtual double delassus(Index r, Index q) const = 0;
};

}  // namespace zwang
