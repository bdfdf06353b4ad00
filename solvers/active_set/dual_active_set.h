#pragma once

#include <zwang/core/problem/islands.h>
#include <zwang/core/problem/shape_cache.h>
#include <zwang/solvers/active_set/goldfarb_idnani.h>
#include <zwang/solvers/common/polish.h>
#include <zwang/solvers/common/setting.h>
#include <zwang/solvers/joint_space/joint_space_active_set.h>

namespace zwang {

extern template class GoldfarbIdnani<double>;

// Goldfarb & Idnani's dual active-set method in double precision, by orthogonal updates (goldfarb_idnani.h).
// One iteration: one row entering or leaving the active set.
//
// A row that was dropped as a combination of others is judged in long double from the problem's own M, J, c, and so is
// a contradiction that rounding could have made. Where the row does not hold to that precision, polish.h decides, as it
// does for nnls and cholesky: consistent after an exchange, contradicted with a proof, or in doubt. `fallback` says so.
struct DualActiveSet {
  static constexpr std::string_view name = "dual_active_set";

  bool reduce = true;  // the fast path of jointed bodies (joint_space_active_set.h) first

  bool polish = true;  // off: the answer of the factors in double, not refined

  static std::vector<Setting<DualActiveSet>> settings() {
    return {{"reduce", &DualActiveSet::reduce,
             "solve in the few unknowns that the joints leave; a sparse QR where no joints say what hangs together"},
            {"polish", &DualActiveSet::polish,
             "refine in extended precision, exchange rows in doubt (off: the method's own answer)"}};
  }

  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

 private:
  // The path that decides ranks row by row.
  class Careful {
   public:
    void solve(const Problem& problem, const DualActiveSet& settings, const SolveOptions& options, Solution& solution);

   private:
    void write(const Problem& problem, Solution& solution) const;
    void judge_again(const Problem& problem, double tolerance, const Deadline& deadline, Solution& solution);

    GoldfarbIdnani<double> method_;
    QrRows active_;
    Polish polish_;
  };

  void solve_island(const Problem& problem, const SolveOptions& options, Solution& solution);
  void solve_carefully(const Problem& problem, const SolveOptions& options, Solution& solution);

  Islands islands_;
  ShapeCache<JointSpaceActiveSet> reduced_;  // by joints: contacts may come and go
  ShapeCache<Careful> careful_;              // by island: sizes depend on ranks
};
static_assert(Solver<DualActiveSet>);

}  // namespace zwang
