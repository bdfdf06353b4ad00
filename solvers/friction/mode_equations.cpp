#include <zwang/solvers/friction/mode_equations.h>

#include <array>
#include <cmath>
#include <utility>

#include <zwang/core/problem/mix_bits.h>
#include <zwang/solvers/form/bound_inside.h>

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
  back_ = false;
  factor_ = 0;
}

bool ModeEquations::choose(const ConeProgram& program, const Vector& y, const Vector& s, double most_weight) {
  const Index nc = program.cones();
  bool changed = false;
  for (Index k = 0; k < nc; ++k) {
    const double slip = most_weight > 1 ? second_order_cone::tangential(&s[3 * k]) : infinity;
    const double weight = y[3 * k] > slip ? std::min(y[3 * k] / slip, most_weight) : 1;
    const Mode now = program.law().mode(&y[3 * k], &s[3 * k], slide[at(k)], weight);
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

double ModeEquations::missed(const ConeProgram& program, const Vector& s) const {
  double most = 0;
  const auto see = [&most](double left) { most = std::max(most, std::abs(left)); };
  const double opening = back_ ? 1 : program.law().opening();
  for (Index k = 0; k < program.cones(); ++k) {
    const auto own = s.segment<3>(3 * k);
    const auto& [u1, u2, size, pressure] = slide[at(k)];
    if (mode[at(k)] == Mode::stick) see(own.lpNorm<Eigen::Infinity>());
    if (mode[at(k)] == Mode::slide) see(own[0] + opening * (u1 * own[1] + u2 * own[2]));
  }
  for (Index r = 0; r < program.rays(); ++r)
    if (active[at(r)]) see(s[3 * program.cones() + r]);
  return most;
}

// Rows as far as they are missed times their weight: of a contact that slides the plane of its ray.
void ModeEquations::pull(const ConeProgram& program, const Vector& missed, Vector& force) const {
  const double opening = program.law().opening(), plane = back_ ? 1 : opening, ray = back_ ? opening : 1;
  for (Index k = 0; k < program.cones(); ++k) {
    const double* D = &D_[at(9 * k)];
    const auto e = missed.segment<3>(3 * k);
    const auto& [u1, u2, size, pressure] = slide[at(k)];
    if (mode[at(k)] == Mode::slide)
      force.segment<3>(3 * k) = D[0] * (e[0] + plane * (u1 * e[1] + u2 * e[2])) * Vec3(1, ray * u1, ray * u2);
    else
      force.segment<3>(3 * k) = Eigen::Map<const Mat3>(D) * e;
  }
  force.tail(program.rays()) = ray_weight_.cwiseProduct(missed.tail(program.rays()));
}

double ModeEquations::least_share(ConeProgram& program) {
  for (Index i = 0; i < ds.size(); ++i) {
    const std::uint64_t bits = mix_bits(static_cast<std::uint64_t>(i) + 1);
    ds[i] = program.source(i) >= 0 ? 0.5 + std::ldexp(static_cast<double>(bits >> 11), -53) : 0;
  }
  pull(program, ds, next);
  pulled_.setZero(program.rows());
  return zwang::least_share(next, softness, most_passes, [&] { take_up(program); });
}

void ModeEquations::take_up(ConeProgram& program) {
  ConeFace& face = program.face();
  face.force(next, dv);
  face.solve(dv);
  face.slack(dv, ds);
  pull(program, ds, pulled_);
  next -= pulled_;
}

bool ModeEquations::keep_still(ConeProgram& program, const Vector& forces) {
  next = forces;
  pulled_.setZero(program.rows());
  const double vanished = tolerances::promise_vanished * forces.norm();
  double before = infinity, moved = infinity;
  do {
    take_up(program);
    before = std::exchange(moved, pulled_.norm());
  } while (next.norm() > vanished && moved > tolerances::derivative_still * next.norm() && moved < before / 2);
  return next.norm() > vanished && moved <= tolerances::derivative_still * next.norm();
}

bool ModeEquations::begin_change(ConeProgram& program, const Vector& y, const Vector& s, bool back) {
  softness = tolerances::derivative_softness;
  back_ = back;
  std::ranges::fill(D_, 0.0);
  for (Index k = 0; k < program.cones(); ++k) {
    const double slip = second_order_cone::tangential(&s[3 * k]), bend = y[3 * k] / slip;
    if (mode[at(k)] == Mode::slide) slide[at(k)] = {-s[3 * k + 1] / slip, -s[3 * k + 2] / slip, bend, bend};
    Eigen::Map<Mat3> D(&D_[at(9 * k)]);
    program.law().linearize(mode[at(k)], slide[at(k)], softness, 1 / bend, program.tilt(k), &y[3 * k], &s[3 * k],
                            D.data(), &next[3 * k]);
    if (back) D.transposeInPlace();
  }
  for (Index r = 0; r < program.rays(); ++r) ray_weight_[r] = active[at(r)] ? 1 / softness : 0;
  return factorize(program);
}

// next = y - D s, y cut to its ray: of what slides the plane's part along the ray, for it is the difference of large
// numbers.
void ModeEquations::aim(const ConeProgram& program, const Vector& y, const Vector& s) {
  pull(program, s, next);
  next = y - next;
  const double ray = back_ ? program.law().opening() : 1;
  for (Index k = 0; k < program.cones(); ++k) {
    if (mode[at(k)] != Mode::slide) continue;
    const auto& [u1, u2, bend, same] = slide[at(k)];
    const double across = bend * (u1 * s[3 * k + 2] - u2 * s[3 * k + 1]), along = next[3 * k];
    next.segment<3>(3 * k) << along, ray * u1 * along + u2 * across, ray * u2 * along - u1 * across;
  }
}

}  // namespace zwang
