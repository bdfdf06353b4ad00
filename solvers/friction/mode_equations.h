#pragma once

#include <vector>

#include <zwang/solvers/friction/cone_program.h>

namespace zwang {

// The modes of a cone program's contacts (cone_law.h), which of its single rows carry force, and Newton's step on their
// equations: M (v + dv) = G'y_new, y_new = next - D G dv, by the factor of M + G'D G.
class ModeEquations {
 public:
  using Mode = ConeLaw::Mode;
  std::vector<Mode> mode;
  std::vector<ConeLaw::Slide> slide;
  std::vector<char> active;         // single rows
  double softness = 1, across = 1;  // the proximal terms of ConeLaw::linearize
  Vector next, dv, ds;              // of the last step; ds = G dv

  void begin(ConeProgram& program);  // all contacts are open
  // Who carries force at (y, s), and which way contacts slide there. Is that another choice than the last?
  bool choose(const ConeProgram& program, const Vector& y, const Vector& s);
  bool slides() const { return std::ranges::find(mode, Mode::slide) != mode.end(); }
  // At (y, s): next, and `anew` D.
  void linearize(const ConeProgram& program, const Vector& y, const Vector& s, bool anew);
  bool factorize(ConeProgram& program);  // false on a breakdown
  // Of the modes as they stand, and still the last that the program made? Also by another who shares the equations.
  bool has_factor(const ConeProgram& program) const { return factor_ != 0 && factor_ == program.factors(); }
  void step(ConeProgram& program, Vector& v, Vector& y);
  // Rows as far as they are missed times their weight: of a contact that slides the plane of its ray.
  void pull(const ConeProgram& program, const Vector& missed, Vector& force) const;

 private:
  std::vector<double> D_;
  Vector ray_weight_, mass_;
  long factor_ = 0;
};

}  // namespace zwang
