#include <zwang/solvers/registry.h>

#include <algorithm>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include <zwang/core/problem/islands.h>
#include <zwang/core/problem/wording.h>
#include <zwang/solvers/active_set/cholesky.h>
#include <zwang/solvers/active_set/dual_active_set.h>
#include <zwang/solvers/active_set/nnls.h>
#include <zwang/solvers/active_set/nnls_paper.h>
#include <zwang/solvers/first_order/apgd.h>
#include <zwang/solvers/first_order/pgs.h>
#include <zwang/solvers/first_order/projected_gradient.h>
#include <zwang/solvers/friction/admm.h>
#include <zwang/solvers/friction/alart_curnier.h>
#include <zwang/solvers/friction/cone.h>
#include <zwang/solvers/friction/fixed_point.h>
#include <zwang/solvers/friction/nsgs.h>
#include <zwang/solvers/newton/newton.h>
#include <zwang/solvers/rivals/bullet.h>
#include <zwang/solvers/rivals/ipopt.h>
#include <zwang/solvers/rivals/mujoco.h>
#include <zwang/solvers/rivals/nlopt.h>
#include <zwang/solvers/rivals/quadratic_programs.h>
#include <zwang/solvers/rivals/siconos.h>

namespace zwang {

// Compiled beside their solvers.
extern template SolverEntry entry<Cholesky>(SolverEntry, Cholesky);
extern template SolverEntry entry<Cone>(SolverEntry, Cone);
extern template SolverEntry entry<DualActiveSet>(SolverEntry, DualActiveSet);
extern template SolverEntry entry<Newton>(SolverEntry, Newton);
extern template SolverEntry entry<Nnls>(SolverEntry, Nnls);

namespace {

// They reach what the tolerance says (the referee's margin: 10 T), or say that they did not.
constexpr Accuracy iterative{.tolerance = 1e-8, .z_error = 1e-7, .certificate = 1e-6, .solved_share = 0.9};
constexpr Accuracy always_solved{.tolerance = 1e-8, .z_error = 1e-7};  // the same, on every feasible problem
// What NLopt and Bullet return is claimed as it is, right as far as stated. SLSQP's subproblem and Dantzig's pivots are
// exact, yet Dantzig returns false on some redundant rows; the others stop on a step length.
constexpr Accuracy pivoting{.tolerance = 1e-8, .z_error = 1e-10};
// MMA and CCSAQ crawl along degenerate rows. Steps of 1e-8 end up to 2.2e-6 away, by the compiler's rounding.
constexpr Accuracy creeping{.tolerance = 1e-8, .z_error = 1e-5, .solved_share = 0.75};

// For `fixed_point`.
AnySolver convex_solver(const std::string& text) {
  const auto reads_it = [](const SolverEntry& e) { return std::ranges::any_of(e.laws, is_convex); };
  if (const SolverEntry* entry = find_solver(text); entry && reads_it(*entry)) return make_solver(text);
  std::string names;
  for (const SolverEntry& e : solvers())
    if (reads_it(e)) names += (names.empty() ? "" : ", ") + e.name;
  throw std::invalid_argument("solver 'fixed_point': setting inner=" + text +
                              " should be a solver of the convex law: " + names);
}

// What methods hand on to others: they do not include each other.
Newton newton() {
  Newton newton;
  newton.start = inside_start();
  newton.dense = DualActiveSet();
  return newton;
}

Cone cone() {
  Cone cone;
  cone.without_friction = {DualActiveSet(), newton()};
  return cone;
}

template <Solver S>
SolverEntry nlopt(const std::string& method, const std::string& limits, const Accuracy& accuracy) {
  return entry<S>({.method = "NLopt 2.7.1 " + method,
                   .limits = limits,
                   .foreign = true,
                   .sees_infeasibility = false,
                   .creeps = accuracy.solved_share < 1,
                   .accuracy = accuracy});
}

std::vector<SolverEntry> always() {
  return {
      entry<DualActiveSet>({.method = "Goldfarb-Idnani by orthogonal updates, refined",
                            .limits = "dense: slow beyond 1000 unknowns",
                            .exact = true,
                            .largest_island = 2000}),
      entry<Ipopt>({.method = "Ipopt 3.11.9: interior point with MUMPS, KKT-checked",
                    .limits = "weakly active rows; near-dependent rows; contacts with friction: 1000 unknowns",
                    .foreign = true,
                    .yardstick = true,
                    .accuracy = iterative}),
      entry<Nnls>(
          {.method = "Lawson-Hanson NNLS on the scaled least-distance form",
           .limits = "dense: time grows with rows x unknowns x active rows; meant for up to a few thousand rows",
           .exact = true,
           .largest_island = 700}),
#if ZWANG_HAS_CHOLMOD
      entry<Cholesky>(
          {.method = "dual active set on the Delassus form, CHOLMOD factor with row updates",
           .limits = "squares the condition number: near-dependent rows go to orthogonal factors (fallback)",
           .exact = true,
           .largest_island = 700}),
#endif
      entry({.method = "augmented-Lagrangian semismooth Newton, sparse Cholesky by 6x6 blocks, polished",
             .limits = "near-dependent rows go to the dense dual active set (fallback), or are reported as such",
             .exact = true},
            newton()),
      entry({.method = "friction cones: interior point, then Newton's method on the modes of the contacts",
             .limits = "Coulomb's law on large piles stalls at 1e-4 to 1e-6, and is then reported",
             .accuracy = always_solved},
            cone()),
      entry<Nsgs>(
          {.method = "nonsmooth Gauss-Seidel, each contact solved exactly (Coulomb's law)",
           .limits = "contacts with friction only; slow on hyperstatic contacts and mass ratios; dense: 1000 unknowns",
           .sees_infeasibility = false,
           .accuracy = iterative}),
      entry({.method = "Coulomb's law by convex problems: a fixed point of the slips, solved by inner=NAME",
             .limits = "contacts with friction only; no convergence where the slips' map does not contract",
             .sees_infeasibility = false,
             .accuracy = always_solved},
            FixedPoint{.make = convex_solver}),
      entry<AlartCurnier>({.method = "semismooth Newton on Alart-Curnier's equations, whole steps",
                           .limits = "contacts with friction only; does not converge from everywhere, and says so",
                           .sees_infeasibility = false,
                           .accuracy = iterative}),
      entry<Admm>(
          {.method = "alternating directions, one factorization for as long as the penalty stays",
           .limits = "contacts with friction only; slow beyond a few digits; may not converge under Coulomb's law",
           .sees_infeasibility = false,
           .accuracy = iterative}),
      // k with J k = c replaces c (docs/formulation.md, gap 2): kept on purpose, to show where the method fails.
      entry<NnlsPaper>(
          {.method = "the paper's Eq. 6-11: k with J k = c, then NNLS",
           .limits = "wrong where c is outside range(J), and blind to infeasibility; the message gives the range gap",
           .exact = true,
           .sees_infeasibility = false,
           .needs_range = true}),
      nlopt<NloptSlsqp>("SLSQP (contains Lawson-Hanson)", "dense; no multipliers; 1000 unknowns", pivoting),
      nlopt<NloptMma>("MMA, equality rows eliminated", "no multipliers; 1000 unknowns", creeping),
      nlopt<NloptCcsaq>("CCSAQ, equality rows eliminated", "no multipliers; 1000 unknowns", creeping),
      nlopt<NloptCobyla>("COBYLA, derivative-free, equality rows eliminated",
                         "no multipliers; slow beyond a few unknowns; 30 unknowns", always_solved),
      entry<ProjectedGradient>(
          {.method = "projected gradient on the dual: the example of docs/add-a-solver.md",
           .limits = "slow; no infeasibility certificates; wrong on near-dependent rows; stops at 20000 steps",
           .accuracy = iterative}),
      entry<Pgs>({.method = "projected Gauss-Seidel on the dual",
                  .limits = "slow on mass ratios, tall stacks; wrong on near-dependent rows; stops at its sweep limit",
                  .accuracy = iterative}),
      entry<Apgd>({.method = "accelerated projected gradient on the dual, restarted",
                   .limits = "slow on mass ratios; wrong on near-dependent rows; stops at its step limit",
                   .accuracy = iterative}),
      entry<BulletDantzig>({.method = "Bullet 3.24's Dantzig MLCP solver on the Delassus form",
                            .limits = "redundant rows; claims what it did not reach; 2000 rows",
                            .foreign = true,
                            .sees_infeasibility = false,
                            .needs_rank = true,
                            .accuracy = {.tolerance = 1e-8, .z_error = 1e-10, .solved_share = 0.95}}),
      entry<BulletPgs>({.method = "Bullet 3.24's projected Gauss-Seidel on the Delassus form",
                        .limits = "as pgs, with step length as its only test; 2000 rows",
                        .foreign = true,
                        .accuracy = {.tolerance = 1e-8, .z_error = 1e-6, .solved_share = 0.95}}),
  };
}

struct Registry {
  std::vector<SolverEntry> solvers = always();
  std::vector<AbsentSolver> absent = {};

  // Optional: its library was found, or else how to add it.
  template <Solver S, bool found>
  void add(std::string_view how_to_add, const SolverEntry& e) {
    if constexpr (found)
      solvers.push_back(entry<S>(e));
    else
      absent.push_back({S::name, how_to_add});
  }

  Registry() {
#if !ZWANG_HAS_CHOLMOD
    absent.push_back({"cholesky", "CHOLMOD's row updates, which are under the GPL: -DZWANG_GPL=ON"});
#endif
    // Its rows are soft: no more is claimed, and that for three problems in five.
    add<MujocoNewton, ZWANG_HAS_MUJOCO>(
        "MuJoCo, Debian's libmujoco-dev",
        {.method = "MuJoCo 2.2.2's Newton solver on soft rows: a yardstick of speed",
         .limits = "rows give way by their force / stiffness; no certificates; 1000 unknowns, 2000 rows",
         .foreign = true,
         .accuracy = {.tolerance = 1e-2, .z_error = 5e-2, .solved_share = 0.6}});
    add<Daqp, ZWANG_HAS_DAQP>("DAQP 0.9, -DZWANG_DAQP_DIR=PREFIX (docs/solvers.md)",
                              {.method = "DAQP 0.9: dual active set on the least-distance form",
                               .limits = "dense: 2000 unknowns, 4000 rows; no iterate at its limits",
                               .foreign = true,
                               .largest_island = 700,
                               .accuracy = iterative});
    add<Piqp, ZWANG_HAS_PIQP>("PIQP 0.6, -DZWANG_PIQP_DIR=PREFIX (docs/solvers.md)",
                              {.method = "PIQP 0.6: proximal interior point, sparse",
                               .limits = "weakly active rows; rarely notices infeasibility; no time limit",
                               .foreign = true,
                               .accuracy = iterative});
    add<Osqp, ZWANG_HAS_OSQP>("OSQP 1, -DZWANG_OSQP_DIR=PREFIX (docs/solvers.md)",
                              {.method = "OSQP 1: operator splitting, sparse, polished",
                               .limits = "slow where many rows are redundant; polishing may fail there",
                               .foreign = true,
                               .accuracy = iterative});
    add<Proxqp, ZWANG_HAS_PROXQP>(
        "ProxSuite 0.7, -DZWANG_PROXQP_DIR=PREFIX (docs/solvers.md)",
        {.method = "ProxQP 0.7: proximal augmented Lagrangian, sparse",
         .limits = "slow where many rows are redundant; rarely notices infeasibility; no time limit",
         .foreign = true,
         .proves_infeasibility = false,
         .accuracy = {.tolerance = 1e-8, .z_error = 1e-6, .certificate = 1e-6, .solved_share = 0.9}});
    add<Qpoases, ZWANG_HAS_QPOASES>("qpOASES 3.2, -DZWANG_QPOASES_DIR=PREFIX (docs/solvers.md)",
                                    {.method = "qpOASES 3.2: parametric active set, its MPC options",
                                     .limits = "dense: 1000 unknowns, 2000 rows; no certificates",
                                     .foreign = true,
                                     .proves_infeasibility = false,
                                     .largest_island = 700,
                                     .accuracy = iterative});
    const auto siconos = [this]<class S>(std::type_identity<S>, const std::string& method, const std::string& limits) {
      add<S, ZWANG_HAS_SICONOS>("Siconos' numerics, Debian's libsiconos-numerics-dev",
                                {.method = "Siconos 4.4: " + method,
                                 .limits = "contacts with friction only; " + limits,
                                 .foreign = true,
                                 .sees_infeasibility = false,
                                 .accuracy = {.tolerance = 1e-6, .z_error = 1e-3, .solved_share = 0}});
    };
    siconos(std::type_identity<SiconosNsgs>(), "500 NSGS", "slow on hyperstatic contacts");
    siconos(std::type_identity<SiconosNsnAc>(), "504 nonsmooth Newton on Alart-Curnier",
            "scaling; answers differ with BLAS threads");
    siconos(std::type_identity<SiconosNsnFb>(), "513 nonsmooth Newton on Fischer-Burmeister", "aborts on some input");
    siconos(std::type_identity<SiconosSoclcp>(), "517 second-order cone LCP, convex law", "few hyperstatic contacts");
    siconos(std::type_identity<SiconosAdmm>(), "523 ADMM", "claims by its own measure");
    siconos(std::type_identity<SiconosGlobalNsgs>(), "605 global NSGS", "seconds on a hand");
    siconos(std::type_identity<SiconosGlobalAdmm>(), "613 global ADMM, sparse", "no further than 1e-5 on large walls");
    siconos(std::type_identity<SiconosGlobalIpm>(), "615 global interior point, convex law",
            "asserts on some input; claims what it did not reach");
  }
};

Registry& registry() {
  static Registry one;
  return one;
}

}  // namespace

std::span<const SolverEntry> solvers() { return registry().solvers; }
std::span<const AbsentSolver> absent_solvers() { return registry().absent; }

void add_solver(SolverEntry entry) {
  if (entry.name.empty() || entry.name.find_first_of(",:=") != std::string::npos)
    throw std::invalid_argument("'" + std::string(entry.name) + "' is no name of a solver: expected one without , : =");
  if (find_solver(entry.name))
    throw std::invalid_argument("a solver of the name '" + entry.name + "' is registered already");
  registry().solvers.push_back(std::move(entry));
}

const SolverEntry* find_solver(std::string_view text, std::span<const SolverEntry> among) {
  const auto found = std::ranges::find(among, text.substr(0, text.find(':')), &SolverEntry::name);
  return found == among.end() ? nullptr : &*found;
}

std::string_view usual_solver(const Problem& problem) {
  if (problem.has_tangents()) return "cone";
  constexpr Index many = 1000;
  const auto inequalities = [](const Problem& p) { return std::ranges::count(p.kind, RowKind::inequality); };
  if (inequalities(problem) <= many) return "dual_active_set";
  Islands islands;
  islands.split(problem);
  const auto large = [&](const Island& island) { return inequalities(island.problem) > many; };
  return std::ranges::any_of(islands.all(), large) ? "newton" : "dual_active_set";
}

bool runs_apart(std::string_view text, std::span<const SolverEntry> among) {
  constexpr std::string_view inner = "inner=";
  const SolverEntry* own = find_solver(text, among);
  const auto at = text.find(inner);
  const SolverEntry* used =
      at == text.npos ? nullptr
                      : find_solver(text.substr(at + inner.size(), text.find(',', at) - at - inner.size()), among);
  return (own && own->foreign) || (used && used->foreign);
}

AnySolver make_solver(std::string_view text, std::span<const SolverEntry> among) {
  const std::string name(text.substr(0, text.find(':')));
  if (const SolverEntry* e = find_solver(name, among))
    return e->make(text.substr(std::min(name.size() + 1, text.size())));
  for (const AbsentSolver& s : absent_solvers())
    if (s.name == name)
      throw std::invalid_argument("solver '" + name + "' is not built in: " + std::string(s.how_to_add));
  throw std::invalid_argument("no solver '" + name + "'" + did_you_mean(name, names_of(among, &SolverEntry::name)) +
                              " (./zwang solvers lists all)");
}

}  // namespace zwang
