#pragma once

#include <zwang/core/problem/islands.h>
#include <zwang/core/problem/shape_cache.h>
#include <zwang/solvers/active_set/joint_space_active_set.h>
#include <zwang/solvers/factor/dual_climb.h>
#include <zwang/solvers/factor/eliminated_rows.h>
#include <zwang/solvers/finish/polish.h>
#include <zwang/solvers/form/warm_rows.h>
#include <zwang/solvers/linalg/dense_storage.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Goldfarb & Idnani's dual active-set method in double precision, by orthogonal updates. S = G G' is never formed, so
// digits are lost as eps / pivot, not eps / pivot^2. One iteration: one row entering or leaving the active set.
//
// Jointed bodies take the fast path (joint_space_active_set.h). The careful one, which decides ranks row by row,
// eliminates the equality rows (eliminated_rows.h) and climbs (dual_climb.h) on
//
//   minimize 1/2 |v|^2   subject to  A v >= b.
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

    // What dual_climb.h asks for, of the columns of A.
    Index choose();
    double split(Index j);
    static bool is_dependent(double length) { return !(length > tolerances::rank * epsilon); }
    double violation(Index j) const { return std::max(0.0, active_.b()[j] - active_.A().col(j).dot(v_)); }
    bool is_satisfied(Index j, double violation) const;
    Blocking<double> blocking() const;
    bool contradicts(Index j, double);
    void retire(Index j) { state_[at(j)] = retired; }
    void move(double step, bool dependent);
    void drop(Index position);
    void append(Index j, double multiplier, double);
    static constexpr bool is_stuck() { return false; }

   private:
    enum State : char { resting, active, retired };
    static constexpr double epsilon = std::numeric_limits<double>::epsilon();

    void require_storage(const Problem& problem, const SolveOptions& options);
    bool equalities_contradict(const Problem& problem, Solution& solution);
    void express(Index row, double sign);
    void warm_start(std::span<const Index> rows);
    void restore_dual_feasibility();
    void write(const Problem& problem, Solution& solution);
    double magnitude(Index j) const { return w_.magnitude[active_.inequalities()[at(j)]]; }
    Index size() { return active_.qr().size(); }

    DenseStorage storage_;
    Whitened w_;
    WarmRows warm_rows_;
    EliminatedRows active_;
    Polish polish_;
    std::vector<Index> place_;    // column of A of each active inequality row, in the factor's order
    std::vector<char> state_;     // of the columns of A
    Vector v_, u_, r_;            // freedom: (v, u), and the entering row's parts along the active ones
    Vector slack_;                // of the columns of A
    Vector y_, rest_, equality_;  // n; padded n; accepted equality rows
    Vector unit_;                 // of the unit rows: multipliers, or the proof of a contradiction
  };

  void solve_island(const Problem& problem, const SolveOptions& options, Solution& solution);
  void solve_carefully(const Problem& problem, const SolveOptions& options, Solution& solution);

  Islands islands_;
  ShapeCache<JointSpaceActiveSet> reduced_;  // by joints: contacts may come and go
  ShapeCache<Careful> careful_;              // by island: sizes depend on ranks
};
static_assert(Solver<DualActiveSet>);

}  // namespace zwang
