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
  // Who carries force at (y, s), and which way contacts slide there. Is that another choice than the last? A slip below
  // its load weighs more (Coulomb's law).
  bool choose(const ConeProgram& program, const Vector& y, const Vector& s, double most_weight = 1);
  bool slides() const { return std::ranges::find(mode, Mode::slide) != mode.end(); }
  // At (y, s): next, and `anew` D.
  void linearize(const ConeProgram& program, const Vector& y, const Vector& s, bool anew);
  bool factorize(ConeProgram& program);  // false on a breakdown
  // Of the modes as they stand, and still the last that the program made? Also by another who shares the equations.
  bool has_factor(const ConeProgram& program) const { return factor_ != 0 && factor_ == program.factors(); }
  void forget_factor() { factor_ = 0; }  // modes were changed
  void step(ConeProgram& program, Vector& v, Vector& y);
  double missed(const ConeProgram& program, const Vector& s) const;  // by rows that carry force, the most
  // An estimate from below of how short a combination of the rows that carry force is; 0 where one may be nearly
  // nothing. By the factor at hand.
  double least_share(ConeProgram& program);
  // next: of forces what moves nothing, where that is more than rounding.
  bool keep_still(ConeProgram& program, const Vector& forces);

  // How an answer changes while its modes stay: the same equations, linear in a change (y, s) of it. begin_change() is
  // at the answer, aim() in place of linearize(). `back`: of the transposed equations.
  bool begin_change(ConeProgram& program, const Vector& y, const Vector& s, bool back);
  void aim(const ConeProgram& program, const Vector& y, const Vector& s);
  static constexpr int most_passes = 12;  // by one factor

 private:
  void take_up(ConeProgram& program);  // of next what the rows' motion takes up
  void pull(const ConeProgram& program, const Vector& missed, Vector& force) const;
  std::vector<double> D_;
  Vector ray_weight_, mass_, pulled_;
  bool back_ = false;
  long factor_ = 0;
};

}  // namespace zwang
