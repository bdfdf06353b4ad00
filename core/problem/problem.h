#pragma once

#include <string>
#include <vector>

#include <zwang/core/problem/types.h>

namespace zwang {

// Gauss' principle of least constraint (docs/formulation.md):
//
//   minimize   1/2 (z - z_u)' M (z - z_u)
//   subject to J z  = c   (equality rows: joints)
//              J z >= c   (inequality rows: contacts, limits)
//
// and, at contacts with friction, one of the laws of types.h on an inequality row and the tangent rows after it.
//
// n = 6 x bodies unknowns in maximal coordinates, [linear; angular] per body, world axes at the centre of mass.
// Units: z, z_u in m/s^2 and rad/s^2; M in kg and kg m^2; each row of J and its c share the row's own unit.
// A row with c = -Inf (inequality only) is inactive for good; any other NaN or Inf is bad input.
template <class Scalar>
struct BasicProblem {
  std::string name = {};
  Eigen::SparseMatrix<Scalar> M = {};                   // n x n, symmetric positive definite, both triangles stored
  VectorX<Scalar> z_u = {};                             // n, the unconstrained motion
  Eigen::SparseMatrix<Scalar, Eigen::RowMajor> J = {};  // m x n
  VectorX<Scalar> c = {};                               // m
  std::vector<RowKind> kind = {};                       // m
  std::vector<RowKey> key = {};                         // m, stable over frames
  VectorX<Scalar> mu = {};      // m, read at inequality rows before tangent rows; empty: there are no tangent rows
  Law law = Law::frictionless;  // what is to be solved; convex or coulomb where there are tangent rows (see under())

  Index size() const { return z_u.size(); }
  Index rows() const { return c.size(); }
  bool is_equality(Index i) const { return kind[at(i)] == RowKind::equality; }
  bool is_tangent(Index i) const { return kind[at(i)] == RowKind::tangent; }
  bool has_tangents() const { return mu.size() > 0; }
  // How many tangent rows follow inequality row i.
  Index tangents(Index i) const {
    Index count = 0;
    while (i + 1 + count < rows() && is_tangent(i + 1 + count)) ++count;
    return count;
  }
};

using Problem = BasicProblem<double>;

// Throws std::invalid_argument, with the sizes in the message, when the parts do not fit together (wrong use).
void require_matching_sizes(const Problem& problem);

// "" or one line saying which entry is not a finite number (c = -Inf on an inequality row is allowed), where M is
// not symmetric, or which mass is below 2^-960. Positive definiteness is found by factorizing: see
// is_positive_definite.
std::string bad_input(const Problem& problem);
bool is_positive_definite(const SparseMatrix& M);
double largest_entry(const RowMatrix& J, Index row);  // in magnitude

// The same problem in another scalar: exact for any scalar that holds every double.
template <class Scalar>
BasicProblem<Scalar> cast(const Problem& p) {
  return {.name = p.name,
          .M = p.M.template cast<Scalar>(),
          .z_u = p.z_u.template cast<Scalar>(),
          .J = p.J.template cast<Scalar>(),
          .c = p.c.template cast<Scalar>(),
          .kind = p.kind,
          .key = p.key,
          .mu = p.mu.template cast<Scalar>(),
          .law = p.law};
}

}  // namespace zwang
