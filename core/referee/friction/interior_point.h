#pragma once

#include <vector>

#include <zwang/core/referee/friction/mode_system.h>

namespace zwang {

// An answer on the way: strictly inside both cones up to the residual that is left.
struct InteriorAnswer {
  ExtendedVector x, lambda;
  std::vector<ContactMode> modes;                                    // by the eigenvalues of both sides
  double complementarity = std::numeric_limits<double>::infinity();  // mean of lambda's~ over the contacts
  double residual = std::numeric_limits<double>::infinity();
  bool converged = false;
};

struct InteriorOptions {
  double start = 1;       // size of the first iterate, of the motion
  double target = 1e-18;  // of the complementarity
  int max_iterations = 80;
  bool keep_iterates = false;
};

// Primal-dual interior point on the cones y = (mu l_n, l_t) and w = (s_n / mu + |s_t|, s_t), Nesterov-Todd scaling
// and Mehrotra's steps. Under Coulomb's law |s_t| is differentiated, which makes the matrix unsymmetric; under the
// convex law sigma stands in its place. Dependent equality rows are left out by `equalities`. Dense: O(rows^3) an
// iteration.
class RefereeInteriorPoint {
 public:
  // equalities: independent equality rows.
  RefereeInteriorPoint(const ContactProblem& problem, std::vector<Index> equalities);

  Index rows() const { return static_cast<Index>(rows_.size()); }

  // sigma: |s_t| of each contact, for the convex problem it makes, or null for Coulomb's law. Real: double,
  // long double (where it is x87's) or DoubleDouble. The last of the answers is the best.
  template <class Real>
  std::vector<InteriorAnswer> solve(const ExtendedVector* sigma, const InteriorOptions& options = {}) const;

 private:
  struct Cone {
    Index first, rows;  // in the dense numbering
    std::size_t contact;
    double mu;  // 1 for a ray
  };
  template <class Real>
  MatrixX<Real> matrix() const;
  template <class Real>
  InteriorAnswer answer(const VectorX<Real>& y, const VectorX<Real>& w) const;

  const ContactProblem* p_;
  std::vector<Index> rows_;  // of the problem, by dense number; equality rows first
  std::vector<Cone> cones_;
  ExtendedVector unit_;    // what a dense row is multiplied by: 1 / mu of a normal one
  MatrixX<FactorReal> W_;  // (J_i M^-1 J_k') in the scaled cones
  Index equalities_ = 0;
};

}  // namespace zwang
