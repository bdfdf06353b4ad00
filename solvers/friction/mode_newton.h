#pragma once

#include <vector>

#include <zwang/solvers/friction/interior_point.h>
#include <zwang/solvers/friction/mode_equations.h>

namespace zwang {

// Where Newton's method on the modes is.
struct ModeIterate {
  Vector v, y, s;  // s = G v - h
  ConeProgram::Residual residual;
};

// From near a solution of a cone program to it: Newton's method on the equations of the modes that contacts are in
// (cone_law.h; Alart & Curnier 1991, Comput. Methods Appl. Mech. Eng. 92),
// with a proximal term in the multipliers, y = y_before - s / softness, so that redundant contacts do no harm: each
// keeps the share of the load that it had. The matrix is M + G'D G once more. The softness follows the residual down: a
// row that depends on others to within the residual would else throw the multipliers about.
//
// Beside a load of 1 a slip of 1e-9 has no say in y - s, in whether a contact slides and which way: loads go to and
// fro. `weighs_slips`: it counts as much as the load, as far as the residual lets it be known. (Not behind the interior
// point, where it costs steps.)
//
// Rows that depend on each other may disagree: by the rounding of what they were written from, or because not all of
// them carry in the end. Then every step hands on a little of the load among them and nothing moves, for thousands of
// steps. run() goes all the way at once, to where one of them lets go.
class ModeNewton : public ModeIterate {
 public:
  // The last step of run() kept the modes, moved v by no more than rounding, and did not halve the residual: what is
  // left of it is what the rows disagree by.
  bool settled = false;

  // From the interior point's iterate, whose eigenvalues tell the modes, or from any.
  void begin(ConeProgram& program, const InteriorPoint& from);
  void begin(ConeProgram& program, const Vector& from_v, const Vector& from_y, bool weighs_slips = false);
  // Until the natural residual is at `goal`, or settled with a residual of at most `leaves`, or the residual
  // does not fall any more; at most so many steps, and on to `last` while each halves the residual. Keeps the best
  // iterate, counts its steps.
  void run(ConeProgram& program, double goal, double leaves, int most, int last, const Deadline& deadline,
           int& iterations);
  // One of its steps; false on a breakdown.
  bool step(ConeProgram& program);
  ModeEquations& equations() { return equations_; }

 private:
  using Mode = ConeLaw::Mode;
  double room(const ConeProgram& program, const Vector& way, const Vector& slack_way) const;
  void shift(ConeProgram& program);

  ModeEquations equations_;
  ModeIterate best_;  // of run()
  Vector way_, push_, slack_way_, y_before_;
  double last_ = 0;
  bool weighs_slips_ = false, chosen_ = false, changed_ = false;  // the modes: before the next step, by the last one
};

}  // namespace zwang
