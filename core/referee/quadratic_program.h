#pragma once

#include <stdexcept>

#include <zwang/core/problem/instance.h>

namespace zwang {

// A strictly convex quadratic program as Python's solvers state it (qpsolvers' convention):
//
//   minimize 1/2 x'Px + q'x   subject to   G x <= h,  A x = b,  lb <= x <= ub
//
// Parts that are absent are empty; infinite entries of h, lb and ub bound nothing.
struct QuadraticProgram {
  SparseMatrix P = {};  // n x n, symmetric positive definite, both triangles
  Vector q = {};        // n
  RowMatrix G = {};     // of h.size() rows
  Vector h = {};
  RowMatrix A = {};  // of b.size() rows
  Vector b = {};
  Vector lb = {}, ub = {};  // n or empty
};

// The same program as a problem of least constraint: M = P, z_u = -P^-1 q, rows named "equality/0", "inequality/17",
// "lower bound/3", "upper bound/3". M, J and c are exact; z_u is rounded. The projection onto the rows does not
// lengthen distances in the P-norm, so the two solutions differ by at most |z_u + P^-1 q|_P, of which `rounding` is a
// bound (in units of sqrt(P) x).
struct AsLeastConstraint {
  Instance instance = {};
  double rounding = 0;

  // qpsolvers' multipliers, P x + q + A'y + G'z + z_box = 0, as lambda of the problem. Empty parts count as zero.
  Vector multipliers(const QuadraticProgram& program, const Vector& y, const Vector& z, const Vector& z_box) const;
};

struct NotDefinite : std::invalid_argument {
  NotDefinite() : std::invalid_argument("P is not positive definite") {}
};

// Throws std::invalid_argument in one line: sizes that do not fit, numbers that are not finite, a P that is not
// symmetric, or as NotDefinite not positive definite.
AsLeastConstraint as_least_constraint(const QuadraticProgram& program);

}  // namespace zwang
