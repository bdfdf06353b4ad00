#pragma once

#include <zwang/solvers/friction/mode_equations.h>
#include <zwang/solvers/prover.h>
#include <zwang/solvers/session.h>

namespace zwang {

// A bound on the error of an answer, proven up to rounding, from multipliers that a method is on its way with
// (SolveOptions::accuracy). With the rows of a cone program, r = M v - G'y for any y in the cones, and v* the answer:
//
//   |v - v*|_M^2 <= |r|_(M^-1) |v - v*|_M + y's + y*'(what s is outside its cones)
//
// (strong monotony, the weak duality of Gauss' problem). Of the iterate itself the middle term makes a bound of
// sqrt(residual), 1e4 times the error. So v is first moved to the nearest point, in the M-norm, of the rows that carry
// force: of a contact that sticks all three, of one that slides the plane of its ray. There y's vanishes, forces that
// pull are cut off into r, and the bound falls like the error; it is zero where the rows were the right ones. Rows that
// are violated then, or pull, are exchanged, a few times. Under Coulomb's law this is the convex problem of the slips
// at v, whose answer v* is then: the self bound.
//
// Rows that depend on each other, or nearly, hide how far v is from meeting them all, in y*' times what is left of the
// rows. Where they are clearly independent there is a point near v that meets them. Else v is moved to where it does,
// along a motion that opens all rows near it, and the promise ends at 1e-7, the square root of rounding. Tried before:
// right sides moved at random tell rows 1e-12 from dependent, and none that are nearer; a bound on the answer's forces
// by the length of that motion ends at the same square root.
class Promise final : public Prover {
 public:
  void begin(const Problem& problem, const SolveOptions& options) override { begin(problem, options, nullptr); }
  // `rows`: the program of this problem that a method works with; a look leaves another factor in its face. It is kept
  // until the next begin(). Else one is built for the first look. `equations`: those of a method that has begun them
  // before the first look, which begins with its factor where the modes are the same.
  void begin(const Problem& problem, const SolveOptions& options, ConeProgram* rows,
             ModeEquations* equations = nullptr);
  double enough(double motion, int exponent) const override;
  bool is_due(double work, double left = infinity, double own = 0) override;
  bool holds(const Vector& lambda, Solution& solution) override;
  bool holds_at(const Vector& y, Solution& solution);  // of the multipliers of `rows`
  bool holds_at(const Vector& y);                      // and where: v(), y()
  bool is_vain() const { return vain_; }
  const Vector& v() const { return v_; }
  const Vector& y() const { return y_; }
  // Has an iterate the modes of the one before? Else a look seldom holds, and costs more than a step on dense rows.
  bool keeps_modes(const Vector& y, const Vector& s) { return prepare() && !modes_->choose(*program_, y, s); }
  void forget() { problem_ = nullptr; }  // rows of an earlier solve: end() keeps those of this one
  // The answer stays as it is, but for the last digits under Coulomb's law: at another point the slips are others.
  void end(const Problem& problem, const SolveOptions& options, Solution& solution) override;
  // The same but for z's own rounding. To state the rows takes as long as a look: a method that has them, asks here.
  // work: as is_due's. A look that takes longer is had only where rows as they are met do not tell enough.
  void judge(const Problem& problem, const SolveOptions& options, Solution& solution, double work = infinity);

 private:
  using Mode = ConeLaw::Mode;
  struct Bound {
    double relative = infinity;  // to the motion
    bool is_enough = false;
  } bound_;

  bool prepare();
  Bound look(bool stands = false);
  bool factorize();
  void linearize(bool anew);
  double settle();
  double with_rounding(double first, double still, double size);
  double inside(double still, double size);
  double along(double still, double size);
  // Of a contact: what its lifted cone leaves of s.
  double opened(Index k) const {
    return s_[3 * k] - program_->law().opening() * second_order_cone::tangential(&s_[3 * k]);
  }
  bool distance();

  const Problem* problem_ = nullptr;
  const SolveOptions* options_ = nullptr;
  Session<ConeProgram> own_;  // opened by the first look: to make one takes a tenth of a small solve
  ConeProgram* program_ = nullptr;
  ModeEquations own_modes_, *modes_ = nullptr;
  bool ready_ = false, failed_ = false, arrived_ = false, takes_any_ = false, stuck_ = false;
  bool hopeless_ = false, vain_ = false;           // no look can hold; the last did not, whatever is asked for
  double factor_rounding_ = 0, row_rounding_ = 0;  // more where M ties unknowns to each other
  double spent_ = 0, price_ = 0, next_look_ = 0, lightest_ = 0;
  double half_ = 0, gap_ = 0;  // of the bound: |r| / 2, and the other terms
  double reach_ = 0;           // the right sides that rounding in a slack comes from
  Vector v_, y_, s_, h_, dv_, ds_, force_, w_, x_, t_;
  std::vector<NearRow> near_;
  Solution scratch_;
};

}  // namespace zwang
