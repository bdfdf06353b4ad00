#pragma once

#include <array>

#include <zwang/solvers/form/unit_program.h>
#include <zwang/solvers/rivals/equality_rows.h>
#include <zwang/solvers/setting.h>

namespace zwang {

enum class NloptMethod { slsqp, mma, ccsaq, cobyla };

// NLopt 2.7.1 (Johnson) on the whitened problem, started at z_u, each row with the constraint tolerance 1e-12 (with
// none at all SLSQP returned its start as success). The status is NLopt's own word; the referee judges it.
//
//   slsqp   sequential quadratic programming (Kraft 1994). Its subproblem is solved by Lawson & Hanson's LSEI, LDP and
//           NNLS, so comparing it with nnls is partly one kernel against itself.
//   mma     method of moving asymptotes (Svanberg 2002);
//   ccsaq   conservative convex separable approximation, quadratic (Svanberg 2002): both take inequality rows only;
//   cobyla  linear approximations without derivatives (Powell 1994): at most 30 unknowns.
//
// mma, ccsaq and cobyla get the problem without equality rows: y = y_0 + N v, with y_0 the shortest y that meets them
// and N an orthonormal basis of what they leave free, keeps the objective 1/2 |v|^2 and is the same problem, smaller.
// slsqp takes equality rows itself and needs that only where they depend on each other; reduce=on always does it.
// mma and ccsaq are restarted where they stop, until a run stays within T of its start.
// AUGLAG is not offered. NLopt returns no multipliers: lambda stays
// empty, since recovering it would be charged to NLopt's time. One iteration is one evaluation of the objective.
template <NloptMethod method>
struct Nlopt {
  static constexpr const char* name =
      std::array{"nlopt_slsqp", "nlopt_mma", "nlopt_ccsaq", "nlopt_cobyla"}[static_cast<std::size_t>(method)];
  static constexpr Index most_unknowns = method == NloptMethod::cobyla ? 30 : 1000;  // dense n^3 work a step

  int max_evaluations = 20000;
  bool reduce = method != NloptMethod::slsqp;  // eliminate the equality rows first

  static std::vector<Setting<Nlopt>> settings() {
    if constexpr (method == NloptMethod::slsqp)
      return {{"max_evaluations", &Nlopt::max_evaluations, "evaluations of the objective before giving up"},
              {"reduce", &Nlopt::reduce, "eliminate the equality rows first"}};
    else
      return {{"max_evaluations", &Nlopt::max_evaluations, "evaluations of the objective before giving up"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  UnitProgram program = {};
  EqualityRows equalities = {};
};

using NloptSlsqp = Nlopt<NloptMethod::slsqp>;
using NloptMma = Nlopt<NloptMethod::mma>;
using NloptCcsaq = Nlopt<NloptMethod::ccsaq>;
using NloptCobyla = Nlopt<NloptMethod::cobyla>;

static_assert(Solver<NloptSlsqp> && Solver<NloptMma> && Solver<NloptCcsaq> && Solver<NloptCobyla>);

}  // namespace zwang
