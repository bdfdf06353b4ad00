#pragma once

#include <vector>

#include <zwang/solvers/friction/cone_program.h>
#include <zwang/solvers/linalg/lanes.h>

namespace zwang {

// A primal-dual interior point on a cone program, with Nesterov-Todd scaling and Mehrotra's predictor and corrector
// (Andersen, Roos & Terlaky 2003, Math. Program. 95): one factorization and two solves a step.
//
// Where slip lifts, as under Coulomb's law, it is the same with w = s + lift |s_t| e_0 in place of s (De Saxce & Feng
// 1998, Math. Comput. Modelling 28). The shift is differentiated where the face takes matrices that are not symmetric,
// with |s_t| rounded off by a part of the gap, and refreshed at each step elsewhere. On the way to a small gap the
// solutions may turn back (a fold: Newton's determinant changes its sign), and steps shrink to nothing. So only a part
// of the slope counts, which falls after steps that were blocked or brought nothing and grows again behind free ones;
// the corrector knows the shift's curvature; the gap does not run ahead of the residual, and stays where it is after a
// blocked step.
//
// Where contacts depend on each other they slip by 1e-9 of the motion, and step() stalls: |s_t| rounded off by a part
// of the gap is then another law, and a residual far below the motion still is far above w. follow() keeps to the
// central path: the residuals shrink with the gap, |s_t| is rounded off by less than w, and no step ends farther from
// the path than a part of the way to the boundary; its length is found by solves alone, one factorization each. The
// tangent to a gap of zero then is an answer to rounding where the modes are not read yet. Where it ends, at a fold or
// in rounding, step() goes on: arc length along the path led back as often as on.
class InteriorPoint {
 public:
  Vector v, y, w;  // the iterate: M v = G'y, and w is s (with the law's shift), up to what is left of the residuals
  Vector s;        // G v - h
  Vector v_end, y_end;  // where the path leads, where sees_end()

  // y = w = `size` program.start() e.
  void begin(ConeProgram& program, double size);
  // One step; false where it breaks down, which leaves the iterate as it was.
  bool step(ConeProgram& program);
  // One step along the central path of Coulomb's law; false where it turns back, or where rounding ends it.
  bool follow(ConeProgram& program);
  bool sees_end() const { return sees_end_; }
  bool follows() const { return path_ > 0; }
  void let_go(ConeProgram& program);                    // for step() to go on
  void forget_path() { path_ = 0, sees_end_ = false; }  // of another program
  double gap() const { return gap_; }                   // the mean of y w
  double last_step() const { return last_step_; }       // of step(): the part of it that was taken
  double residual() const { return residual_; }         // the largest entry of what is left
  // y as far as it proves that no v meets the rows (convex law): u in the cones, h'u beyond |G'u|_M^-1 of any motion.
  bool proves_infeasible(ConeProgram& program, Vector& u);

 private:
  using Pack = lanes::PackOf<1>;
  struct Few {  // what weigh() knows of a few cones, one a lane; whatever behind the last one
    second_order_cone::Scaling<Pack> scaling;
    Pack slope1, slope2;                                         // of the shift
    [[gnu::always_inline]] std::array<Pack, 9> weight() const {  // D
      std::array<Pack, 9> D = scaling.weight();
      for (std::size_t i = 0; i < 3; ++i) {
        D[i + 3] += D[i] * slope1;
        D[i + 6] += D[i] * slope2;
      }
      return D;
    }
  };

  void measure_rows(const ConeProgram& program);
  void measure(ConeProgram& program);
  bool weigh(const ConeProgram& program, bool couples);
  void aim(const ConeProgram& program);
  double off_path(const ConeProgram& program, double gap) const;
  void round_off(const ConeProgram& program, double gap);
  void head_for(ConeProgram& program, double gap, bool curved);
  bool reaches(ConeProgram& program, double gap);
  void move(const ConeProgram& program, double step);
  bool take(ConeProgram& program, double step, double next_width);
  void direct(ConeProgram& program);
  void bend(const ConeProgram& program, double part);
  void correct(const ConeProgram& program, double centre);
  double step_length(const ConeProgram& program) const;
  double gap_after(const ConeProgram& program, double step) const;

  double gap_ = 0, residual_ = 0, coupling_ = 1, last_step_ = 1;
  Vector left_, dv_, force_, mass_, ds_, dy_, dw_, target_, sum_, ray_weight_, bend_;
  // The central path: its gap, the width of the next step, what is left of the residuals in units of the gap.
  double path_ = 0, width_ = 0;
  bool sees_end_ = false;
  Vector left_share_, force_share_, aim_, rounding_, begun_y_, begun_w_, begun_s_;
  std::vector<double> D_;
  std::vector<Few> few_;
  Index degree_ = 1;
};

}  // namespace zwang
