#include <zwang/solvers/friction/mode_equations.h>

#include <array>

namespace zwang {

void ModeEquations::begin(ConeProgram& program) {
  const Index n = program.face().unknowns();
  mode.assign(at(program.cones()), Mode::open);
  slide.resize(at(program.cones()));
  active.assign(at(program.rays()), 0);
  D_.assign(at(9 * program.cones()), 0);
  ray_weight_.setZero(program.rays());
  for (Vector* x : {&next, &ds}) x->setZero(program.rows());
  for (Vector* x : {&dv, &mass_}) x->setZero(n);
  factor_ = 0;
}

bool ModeEquations::choose(const ConeProgram& program, const Vector& y, const Vector& s) {
  const Index nc = program.cones();
  bool changed = false;
  for (Index k = 0; k < nc; ++k) {
    const Mode now = program.law().mode(&y[3 * k], &s[3 * k], slide[at(k)]);
    changed = changed || now != mode[at(k)];
    mode[at(k)] = now;
  }
  for (Index r = 0; r < program.rays(); ++r) {
    const char now = program.is_equality(r) || y[3 * nc + r] - s[3 * nc + r] > 0;
    changed = changed || now != active[at(r)];
    active[at(r)] = now;
  }
  if (changed) factor_ = 0;
  return changed;
}

void ModeEquations::linearize(const ConeProgram& program, const Vector& y, const Vector& s, bool anew) {
  const Index nc = program.cones();
  std::array<double, 9> unused;
  if (anew) std::ranges::fill(D_, 0.0);
  next.setZero();
  for (Index k = 0; k < nc; ++k)
    program.law().linearize(mode[at(k)], slide[at(k)], softness, across, program.tilt(k), &y[3 * k], &s[3 * k],
                            anew ? &D_[at(9 * k)] : unused.data(), &next[3 * k]);
  for (Index r = 0; r < program.rays(); ++r) {
    if (anew) ray_weight_[r] = active[at(r)] ? 1 / softness : 0;
    if (const Index i = 3 * nc + r; active[at(r)]) next[i] = y[i] - ray_weight_[r] * s[i];
  }
}

bool ModeEquations::factorize(ConeProgram& program) {
  const bool symmetric = !program.law().lifts() || !slides();
  factor_ = 0;
  if (!symmetric && !program.face().takes_unsymmetric()) return false;
  if (!program.factorize(D_, ray_weight_, symmetric)) return false;
  factor_ = program.factors();
  return true;
}

void ModeEquations::step(ConeProgram& program, Vector& v, Vector& y) {
  ConeFace& face = program.face();
  face.force(next, dv);
  face.mass(v, mass_);
  dv -= mass_;
  face.solve(dv);
  face.slack(dv, ds);
  v += dv;
  for (Index k = 0; k < program.cones(); ++k) {
    const double *D = &D_[at(9 * k)], *d = &ds[3 * k];
    for (Index i = 0; i < 3; ++i) y[3 * k + i] = next[3 * k + i] - (D[i] * d[0] + D[i + 3] * d[1] + D[i + 6] * d[2]);
  }
  const Index rays = program.rays();
  y.tail(rays) = next.tail(rays) - ray_weight_.cwiseProduct(ds.tail(rays));
}

void ModeEquations::pull(const ConeProgram& program, const Vector& missed, Vector& force) const {
  const double opening = program.law().opening();
  for (Index k = 0; k < program.cones(); ++k) {
    const double* D = &D_[at(9 * k)];
    const auto e = missed.segment<3>(3 * k);
    const auto& [u1, u2, size, pressure] = slide[at(k)];
    if (mode[at(k)] == Mode::slide)
      force.segment<3>(3 * k) = D[0] * (e[0] + opening * (u1 * e[1] + u2 * e[2])) * Vec3(1, u1, u2);
    else
      force.segment<3>(3 * k) = Eigen::Map<const Mat3>(D) * e;
  }
  force.tail(program.rays()) = ray_weight_.cwiseProduct(missed.tail(program.rays()));
}

}  // namespace zwang
