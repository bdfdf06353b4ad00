#pragma once

#include <zwang/core/problem/islands.h>
#include <zwang/core/problem/shape_cache.h>
#include <zwang/solvers/active_set/careful_climb.h>
#include <zwang/solvers/active_set/joint_space_active_set.h>
#include <zwang/solvers/finish/polish.h>
#include <zwang/solvers/form/warm_rows.h>
#include <zwang/solvers/linalg/dense_storage.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Goldfarb & Idnani's dual active-set method in double precision, by orthogonal updates. S = G G' is never formed, so
// digits are lost as eps / pivot, not eps / pivot^2. One iteration: one row entering or leaving the active set.
//
// Jointed bodies take the fast path (joint_space_active_set.h). The careful one eliminates the equality rows
// (eliminated_rows.h) and decides ranks row by row (careful_climb.h).
//
// Polish (solvers/finish/polish.h) then solves the active rows afresh from the problem's own M, J, c in extended
// precision, so the answer does not carry the path's rounding and a warm start gives the digits of a cold one; it
// exchanges rows where the mended answer changes a decision, and proves contradictions. `fallback` says that it had to
// change the active set, or to go on in double-double.
struct DualActiveSet {
  static constexpr std::string_view name = "dual_active_set";

  bool reduce = true;  // the fast path of jointed bodies first

  bool polish = true;  // off: the answer of the factors in double, not refined

  static std::vector<Setting<DualActiveSet>> settings() {
    return {{"reduce", &DualActiveSet::reduce,
             "solve in the few unknowns that the joints leave; a sparse QR where no joints say what hangs together"},
            {"polish", &DualActiveSet::polish,
             "refine in extended precision, exchange rows in doubt (off: the method's own answer)"}};
  }

  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

 private:
  class Careful {
   public:
    void solve(const Problem& problem, const DualActiveSet& settings, const SolveOptions& options, Solution& solution);

   private:
    bool equalities_contradict(const Problem& problem, Solution& solution);
    void write(const Problem& problem, Solution& solution);

    DenseStorage storage_;
    Whitened rows_;
    WarmRows warm_rows_;
    CarefulClimb climb_;
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
