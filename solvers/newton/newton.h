#pragma once

#include <limits>
#include <string_view>
#include <vector>

#include <zwang/solvers/active_set/dual_active_set.h>
#include <zwang/solvers/finish/extended_polish.h>
#include <zwang/solvers/first_order/stop.h>
#include <zwang/solvers/form/unit_rows.h>
#include <zwang/solvers/form/warm_rows.h>
#include <zwang/solvers/linalg/block_cholesky.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Augmented-Lagrangian semismooth Newton, for large stacks: sparse all through.
//
//   minimize over d   1/2 d'Md + 1/(2 s) sum of max(0, l_i + s (h_i - g_i d))^2      (equality rows without the max)
//
// by Newton's method with the matrix M + s G_A'G_A, A the rows in the max, and an exact line search on the piecewise
// quadratic, apart for every part that shares no unknown; then l_i := max(0, l_i + s (h_i - g_i d)) (Rockafellar 1976,
// Math. Oper. Res. 1; Li, Sun & Toh 2018, SIAM J. Optim. 28). Redundant rows do no harm: M > 0 keeps the matrix
// definite, and l stays finite as long as the rows agree. One iteration is one Newton step.
//
// The polish repeats the same step on the active set with residuals of the problem's own M, J, c in long double,
// until d and l hold in that precision, rows leave whose multiplier is negative and rows enter that are violated. Each
// step shrinks the error by 1 / (1 + s mu), mu the smallest nonzero eigenvalue of G_A G_A', so the speed at which
// it converges tells whether mu can be trusted. Where it cannot (near-parallel rows, contradictions), a problem small
// enough goes to the dual active-set method (Solution::handed_to, with its iterations); a larger one is reported as
// what it is. With polish=off the method goes on alone until a step of l moves d by less than the tolerance.
//
// Tried, on walls of 1000 bricks: from d = 0 with s = 1e4, ten times that at each step of l: 24 factorizations; from
// all near rows held with s = 1e6: 2 to 11. s beyond 1e7 before the polish stirs up rows with no force of their own (60
// factorizations and more), since the slack then carries rounding into the choice of rows; so s grows only where l
// converges slowly, and the polish takes over once a step of l moves d by 1e-5. Inner problems solved coarsely: more
// steps, not fewer. A step cut short by the line search is no sign of being near, only the whole step's length is. What
// fails: piles of spheres with small gaps (500: 62 steps from s = 100, 168 from 1e4), and arches of 100 wedges, whose
// smallest eigenvalue no s reaches, go to the dense method.
struct Newton {
  static constexpr std::string_view name = "newton";
  double penalty = 100;  // s at the start
  bool hold_all = true;  // start from all near rows held
  bool polish = true;    // off: d and l as Newton's method leaves them, and no other method

  static std::vector<Setting<Newton>> settings() {
    return {
        {"penalty", &Newton::penalty, "first weight of a violated unit row against M"},
        {"hold_all", &Newton::hold_all, "start from all rows near z_u held, where that pulls on few"},
        {"polish", &Newton::polish,
         "solve the active rows again in extended precision, go to dual_active_set where that fails (off: neither)"}};
  }

  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

 private:
  using Real = long double;
  static_assert(std::numeric_limits<Real>::digits >= 64, "the polish needs more digits than double has");
  using RealVector = VectorX<Real>;
  enum class End { settled, limit, infeasible, stuck };

  struct Search {  // the line search of one part
    double zero = 0, linear = 0, quadratic = 0, step = 1, low = 0, high = 0, derivative = 0, slope = 0;
    bool done = false;
  };

  void prepare(const Problem& p, const SolveOptions& options, const Deadline& deadline);
  void multiply_mass(const Problem& p, const Vector& x, Vector& y) const;
  double mass_norm(const Problem& p, const Vector& x);
  bool factorize(const Problem& p, const Deadline& deadline);
  double row_dot(Index i, const Vector& x) const {
    double sum = 0;
    for (auto p = entries(i); p < entries(i + 1); ++p) sum += rows_.g.value[p] * x[place_[p]];
    return sum;
  }
  void add_row(Index i, double factor, Vector& x) const {
    for (auto p = entries(i); p < entries(i + 1); ++p) x[place_[p]] += factor * rows_.g.value[p];
  }
  std::size_t entries(Index i) const { return static_cast<std::size_t>(rows_.g.begin[static_cast<std::size_t>(i)]); }
  bool is_equality(Index i) const { return rows_.equality[static_cast<std::size_t>(i)] != 0; }

  bool rests() const;
  void weigh(double s);
  bool start(const Problem& p, const Deadline& deadline);
  End descend(const Problem& p, double close, const SolveOptions& options, const Deadline& deadline, Solution& s);
  bool line_search(double s);

  bool solve_alone(const Problem& p, const SolveOptions& options, const Deadline& deadline, Solution& solution);
  bool judge(const Problem& p, const SolveOptions& options, const Deadline& deadline, Solution& solution);
  bool polish_answer(const Problem& p, const SolveOptions& options, const Deadline& deadline, Solution& solution);
  void extended_force(const Problem& p);
  bool certify(const Problem& p, const Deadline& deadline, Solution& solution);
  void write(const Problem& p, Solution& solution) const;

  UnitRows rows_;
  WarmRows warm_rows_;
  BlockCholesky factor_;
  std::vector<int> place_;  // of every entry of the rows: its column's position
  struct MassEntry {
    int row, column, from;
  };
  std::vector<MassEntry> mass_;  // of M, by position, both triangles

  Vector d_, start_, step_, force_, product_, work_;  // by position
  Vector l_, h_, slack_, term_, change_, weight_;     // rows; slack_ = h - G d, term_ = l + s slack
  std::vector<Search> search_;
  RealVector far_d_, far_l_, far_force_, violation_;
  double s_ = 0, scale_ = 0, reach_ = 0;
  double rate_ = 1;  // by which an exact step of l shrinks the error, as last seen

  ExtendedPolish<FactorReal> proof_;
  DualActiveSet exact_;
};
static_assert(Solver<Newton>);

}  // namespace zwang
