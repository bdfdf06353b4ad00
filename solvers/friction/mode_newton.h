#pragma once

#include <vector>

#include <zwang/solvers/friction/interior_point.h>

namespace zwang {

// From near a solution of a cone program to it: Newton's method on the equations of the modes that contacts are in
// (cone_law.h; Alart & Curnier 1991, Comput. Methods Appl. Mech. Eng. 92),
// with a proximal term in the multipliers, y = y_before - s / softness, so that redundant contacts do no harm: each
// keeps the share of the load that it had. The matrix is M + G'D G once more. The softness follows the residual down: a
// row that depends on others to within the residual would else throw the multipliers about.
//
// Rows that depend on each other may disagree: by the rounding of what they were written from, or because not all of
// them carry in the end. Then every step hands on a little of the load among them and nothing moves, for thousands of
// steps. run() goes all the way at once, to where one of them lets go.
class ModeNewton {
 public:
  Vector v, y, s;
  ConeProgram::Residual residual;
  // The last step of run() kept the modes, moved v by no more than rounding, and did not halve the residual: what is
  // left of it is what the rows disagree by.
  bool settled = false;

  // From the interior point's iterate, whose eigenvalues tell the modes, or from (v, y) as they stand.
  void begin(ConeProgram& program, const InteriorPoint& from);
  void begin(ConeProgram& program);
  void begin(ConeProgram& program, const Vector& from_v, const Vector& from_y);
  // Until the natural residual is at `goal`, or settled with a residual of at most `leaves`, or the residual
  // does not fall any more; keeps the best iterate. Counts its steps.
  void run(ConeProgram& program, double goal, double leaves, int most, const Deadline& deadline, int& iterations);
  // One of its steps; false on a breakdown.
  bool step(ConeProgram& program);

 private:
  using Mode = ConeLaw::Mode;
  void choose(ConeProgram& program);
  void linearize(ConeProgram& program);
  bool solve(ConeProgram& program);
  double room(const ConeProgram& program, const Vector& way, const Vector& slack_way) const;
  void shift(ConeProgram& program);

  std::vector<Mode> mode_, mode_before_;
  std::vector<ConeLaw::Slide> slide_;
  std::vector<char> ray_active_, ray_before_;
  std::vector<double> D_;
  Vector ray_weight_, next_, dv_, mass_, ds_, best_v_, best_y_, best_s_, y_before_;
  double softness_ = 1, last_ = 0;
  bool chosen_ = false;
};

}  // namespace zwang
