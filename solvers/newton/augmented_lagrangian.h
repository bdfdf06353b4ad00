#pragma once

#include <limits>
#include <vector>

#include <zwang/solvers/form/unit_rows.h>
#include <zwang/solvers/form/warm_rows.h>
#include <zwang/solvers/linalg/block_cholesky.h>

namespace zwang {

// The augmented Lagrangian of unit rows (unit_rows.h), for multipliers l and a penalty s,
//
//   1/2 d'Md + 1/(2 s) sum of max(0, l_i + s (h_i - g_i d))^2      (equality rows without the max),
//
// the iterate (d, l), and the steps that lead down from it: by the sparse factor of M + s G_A'G_A, A the rows in the
// max. Vectors of unknowns are in the order of that factor.
class AugmentedLagrangian {
 public:
  using Real = long double;
  static_assert(std::numeric_limits<Real>::digits >= 64, "the polish needs more digits than double has");
  using RealVector = VectorX<Real>;

  UnitRows rows;  // to be built before begin()
  Vector d, l;    // the iterate
  Vector weight;  // of the rows: s in A, else 0
  double s = 0;
  double hold_penalty = tolerances::newton_hold;  // s while near rows are held
  double rate = 1;                                // by which an exact step of l shrinks the error, as last seen
  double scale = 0;                               // max(|z_u|_M, |d|_M), as of the last step of d

  // d = 0, and l of an earlier frame. The problem is kept until the next begin().
  void begin(const Problem& problem, const SolveOptions& options, const Deadline& deadline, double penalty);
  // What rows held as if they were equality rows tell of those that carry a force: all but known; known but for few, or
  // the iterate far from them; or nothing, where they pull too much.
  enum class Held { known, few_left, many_left, none };
  // From all rows near z_u held; where that tells nothing, d = l = 0 as before.
  Held hold_near(const Deadline& deadline);
  // From another method's z and lambda: the rows held that push more than they stand off.
  void hold_pushing(const Vector& z, const Vector& lambda, const Deadline& deadline);
  bool rests() const;  // z_u breaks no row

  void linearize();  // A, at d
  bool factorize(const Deadline& deadline);
  // Newton's step of d, in each part that shares no unknown as far as it leads down. Returns its length before that.
  double step();
  bool keeps_rows() const;  // A is as before the step, which was taken whole
  // Such steps until one is short beside `last_move`, by which the last step of l moved d, or nothing but rounding, or
  // keeps_rows(): solved then. Counts them.
  Status minimize(double last_move, const SolveOptions& options, const Deadline& deadline, Solution& solution);
  double step_multipliers();            // l := max(0, l + s (h - G d)), by the step u; returns h'u
  double distance(const Vector& from);  // |d - from|_M

  // For steps of other kinds by the same factor.
  Index unknowns() const { return factor_.size(); }
  bool is_equality(Index i) const { return rows.equality[at(i)] != 0; }
  double violation(Index i) const { return h_[i] - dot(i, d); }
  double dot(Index i, const Vector& x) const {
    double sum = 0;
    for (auto p = entries(i); p < entries(i + 1); ++p) sum += rows.g.value[p] * x[place_[p]];
    return sum;
  }
  template <class Scalar>
  void add(Index i, Scalar factor, VectorX<Scalar>& x) const {
    for (auto p = entries(i); p < entries(i + 1); ++p) x[place_[p]] += factor * Scalar(rows.g.value[p]);
  }
  void solve(Vector& x) const { factor_.solve(x); }
  double mass_norm(const Vector& x);
  double force_norm(const Vector& f);  // |f|_(M^-1)
  // J'l - M d and h - G d, from the problem's stored doubles.
  void residuals(const RealVector& far_d, const RealVector& far_l, RealVector& force, RealVector& violation) const;
  // z and lambda of any d and l.
  template <class Unknowns, class Multipliers>
  void write(const Unknowns& motion, const Multipliers& multipliers, Solution& solution) const;
  void write_rest(Solution& solution);  // z_u is the answer
  // One more iteration, shown with these multipliers to who observes.
  void count(const Vector& multipliers, const SolveOptions& options, Solution& solution) const;

 private:
  struct Part {  // of the line search
    double zero = 0, linear = 0, quadratic = 0, step = 1, low = 0, high = 0, derivative = 0, slope = 0;
    bool done = false;
  };

  std::size_t entries(Index i) const { return at(rows.g.begin[at(i)]); }
  Part& part_of(Index unknown) { return part_[at(factor_.part_of_position(static_cast<int>(unknown)))]; }
  Held hold(const Deadline& deadline);
  void search();

  const Problem* problem_ = nullptr;
  WarmRows warm_rows_;
  BlockCholesky factor_;
  std::vector<int> place_;  // of every entry of the rows: its column's position
  std::vector<MatrixEntry> mass_;
  Vector step_, force_, product_, work_, columns_;
  Vector h_, term_, change_;  // rows: term_ = l + s (h - G d), change_ = G step
  std::vector<Part> part_;
};

template <class Unknowns, class Multipliers>
void AugmentedLagrangian::write(const Unknowns& motion, const Multipliers& multipliers, Solution& solution) const {
  solution.z = problem_->z_u;
  for (int j = 0; j < factor_.size(); ++j) {
    double& z = solution.z[factor_.column(j)];
    z = static_cast<double>(Real(z) + std::ldexp(Real(motion[j]), rows.exponent));
  }
  solution.lambda.setZero(problem_->rows());
  for (Index i = 0; i < rows.rows(); ++i) {
    const Real own = is_equality(i) ? Real(multipliers[i]) : std::max(Real(multipliers[i]), Real(0));
    solution.lambda[rows.row[at(i)]] = rows.multiplier(i, own);
  }
  rows.move_faint(solution.lambda, solution.z);
}

}  // namespace zwang
