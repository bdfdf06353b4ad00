#pragma once

#include <zwang/solvers/finish/extended_polish.h>
#include <zwang/solvers/newton/augmented_lagrangian.h>

namespace zwang {

// Newton's steps of both d and l on the active set, with residuals of the problem's own M, J, c in long double, until d
// and l hold in that precision; rows leave whose multiplier is negative and rows enter that are violated. Each step
// shrinks the error by 1 / (1 + s mu), mu the smallest nonzero eigenvalue of G_A G_A', so the speed at which it
// converges tells whether mu can be trusted.
class NewtonPolish {
 public:
  // There is no other method, one that computes with more digits. Where rows repeat each other and do not agree to the
  // last digit, one then lets go after the other (which of them decide hangs on rounding, and the answer says so:
  // solved_ill_conditioned), and the penalty grows where rows all but repeat each other. Else run() fails there.
  bool alone = false;
  // The error that is enough, in the M-norm in the unit of L; 0: the least. Of many unknowns a bound so small ends
  // run(); of few one that is so small is said. Only where no row is an equality row.
  double enough = 0;
  bool asks = false;      // for another bound, where that is none
  bool doubtful = false;  // run() has settled, but on rows which so nearly depend on each other that it may not be so

  // From the iterate of L, whose weights and rate it changes. False where it does not converge; on true the solution is
  // complete, and counts a step for each factorization that another active set asked for.
  bool run(AugmentedLagrangian& L, double tolerance, const Deadline& deadline, Solution& solution);
  // What the iterate is worth as it stands. run() tells how far it is off, and its answer is thrown away. One step of
  // it would not do: where rows are nearly dependent, the rate of convergence hides the slowest direction.
  bool judge(AugmentedLagrangian& L, double tolerance, const Deadline& deadline, Solution& solution);
  // Where the rows contradict each other, l grows by s times the violations that no d can mend, and these are a Farkas
  // vector: u >= 0 on inequality rows, G'u = 0, h'u > 0. What is left of G'u is taken out by the same contraction;
  // extended_polish.h then judges the vector as the referee will see it. Changes the weights of L.
  bool certify(AugmentedLagrangian& L, const Problem& problem, const Deadline& deadline, Solution& solution);
  // From another method's vector, in solution.certificate.
  bool certify_again(AugmentedLagrangian& L, const Problem& problem, const Deadline& deadline, Solution& solution);

 private:
  using Real = AugmentedLagrangian::Real;
  using RealVector = AugmentedLagrangian::RealVector;

  bool certify_rows(AugmentedLagrangian& L, const Problem& problem, const Deadline& deadline, Solution& solution);
  bool exchange(AugmentedLagrangian& L, double worst);
  bool let_go(AugmentedLagrangian& L);
  bool strengthen(AugmentedLagrangian& L);
  double step(AugmentedLagrangian& L);
  void open(AugmentedLagrangian& L, bool equality, double turn = 0);
  double bound(AugmentedLagrangian& L);
  double bound_at(AugmentedLagrangian& L);
  bool is_doubtful(AugmentedLagrangian& L);
  void contract(AugmentedLagrangian& L, RealVector& u);

  RealVector d_, l_, force_, violation_, nothing_;
  Vector step_, unit_;
  // Of the rows: how far the motion of open() opens them, and by how much it misses its aim. Its length.
  Vector open_;
  RealVector missed_;
  double open_length_ = 0;
  std::vector<NearRow> near_;
  double bound_ = 0;  // what bound() returned last
  ExtendedPolish<FactorReal> proof_;
};

}  // namespace zwang
