#pragma once

#include <zwang/solvers/form/unit_program.h>
#include <zwang/solvers/friction/cone_program.h>
#include <zwang/solvers/rivals/equality_rows.h>
#include <zwang/solvers/rivals/ipopt.h>
#include <zwang/solvers/session.h>

namespace zwang {

class IpoptSession;
struct IpoptAnswer;
struct IpoptQuestion;

// Ipopt 3.11.9 (Waechter & Biegler 2006), interior point with MUMPS, on the whitened problem with settings a convex QP
// deserves: constant Jacobians and Hessian announced, bounds not relaxed, no scaling on top of unit rows, start at
// y = 0. Rows enter as G y - h, so their bounds are 0 and the slacks keep full precision. The tolerance T goes to
// Ipopt as tol = dual_inf_tol = constr_viol_tol = T/2 and compl_inf_tol = T^2/4 (>= 1e-22), because lambda_i slack_i
// <= T alone leaves a weakly active row off by sqrt(T). Settling for an "acceptable" point is switched off.
// Ipopt refuses more equality rows than unknowns and stumbles over dependent ones: those are dropped by a
// rank-revealing QR beforehand and reported as redundant, unless they contradict the rest, which proves infeasibility.
// Ipopt's word for success (return codes 0, 1 and 3) counts only if the whole problem's KKT check holds to
// max(T, 1e-13); otherwise it is a numerical failure. One iteration is one interior-point iteration.
// A complementarity below 1e-16 cannot always be reached: the step to the boundary is 1 - mu, which rounds to 1 there,
// so slacks become 0 and Ipopt wanders off (LMGC_100_PR_PerioBox of FCLIB: KKT residual below 1e-13 on the way, 1e-6 at
// its end). So where Ipopt ends stuck, the best of its iterates is taken if it passes the same check; not at an
// iteration or time limit.
//
// Contacts with friction, under the convex law, are asked as smooth constraints: s_0^2 >= s_1^2 + s_2^2 and s_0 >= 0 of
// each cone (ipopt_session.cpp), on dense rows in the freedoms that joints leave. The squares have no gradient where a
// contact sticks, so constraint qualifications fail there. What comes back is claimed where it passes the test of the
// solvers on cones (ConeProgram::accepts). "Infeasible" is Ipopt's word without a proof, and is not passed on.
struct IpoptMethod : IpoptSettings {
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  UnitProgram program = {};
  EqualityRows equalities = {};
  std::vector<Index> rows = {};  // of `program`, that Ipopt is asked about
  ConeProgram cones = {};
  Vector v = {}, slack = {};
  Session<IpoptSession> session = {};

 private:
  IpoptQuestion& ask(const SolveOptions& options, const Deadline& deadline);
  const IpoptAnswer& run(Solution& solution);
  void solve_cones(const Problem& problem, const SolveOptions& options, Solution& solution);
  bool holds(const Vector& v, const Vector& y, const SolveOptions& options);
};

static_assert(Solver<IpoptMethod>);

}  // namespace zwang
