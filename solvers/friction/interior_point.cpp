#include <zwang/solvers/friction/interior_point.h>

#include <algorithm>
#include <cmath>

namespace zwang {
namespace {

namespace soc = second_order_cone;
// Of the slacks of a start, in units of its size: far below where their squares overflow.
constexpr double farthest = 1 / tolerances::cone_deepest;
// How the coupling of Coulomb's law is damped.
namespace damping {
// Of the way to the end of Newton's step: shorter ones were blocked, longer ones free, the longest whole.
constexpr double blocked = 0.3, free_step = 0.5, whole = 0.98;
// A whole step that leaves more than this of a residual above the gap brought nothing.
constexpr double left_over = 0.9;
// The part of the shift's slope that counts falls by `less`, and grows by `more` and a little.
constexpr double less = 0.85, more = 1.3, little = 0.02;
// The least centring in units of residual / gap, but at most the second.
constexpr double of_residual = 0.03, most_of_residual = 0.3;
}  // namespace damping

}  // namespace

// On the central path of a gap of about size start(). What is farther open at v = 0 starts there: from w = size start()
// a hand that hardly presses, whose other contacts are 1e7 times as far away, took 40 steps to let them go.
void InteriorPoint::begin(ConeProgram& program, double size) {
  const Index m = program.rows(), n = program.face().unknowns(), nc = program.cones();
  for (Vector* x : {&y, &w, &s, &left_, &ds_, &dy_, &dw_, &target_, &sum_}) x->setZero(m);
  for (Vector* x : {&v, &dv_, &force_, &mass_}) x->setZero(n);
  ray_weight_.setZero(program.rays());
  D_.assign(at(9 * nc), 0);
  cone_.resize(at(nc));
  degree_ = 2 * nc;
  const double first = size * program.start();
  program.slack(v, s);
  for (Index k = 0; k < nc; ++k) {
    double *Y = &y[3 * k], *W = &w[3 * k], *slack = &s[3 * k];
    Y[0] = first * program.tilt(k);
    W[0] = first * std::max(1.0, 1 / program.tilt(k));
    slack[0] += program.law().shift(slack);
    if (!(soc::smallest(slack) > W[0] && soc::largest(slack) < farthest * first)) continue;
    const double share = Y[0] * (W[0] / soc::determinant(slack));
    for (int i = 0; i < 3; ++i) {
      W[i] = slack[i];
      Y[i] = (i == 0 ? share : -share) * slack[i];
    }
  }
  for (Index r = 0; r < program.rays(); ++r) {
    const Index i = 3 * nc + r;
    if (program.is_equality(r)) continue;
    w[i] = std::clamp(s[i], first, farthest * first);
    y[i] = first * (first / w[i]);
    ++degree_;
  }
  degree_ = std::max<Index>(degree_, 1);
  bend_.setZero(nc);
  coupling_ = last_step_ = 1;
  if (program.is_dense()) program.face().force(y, v);
  measure(program);
}

void InteriorPoint::measure(ConeProgram& program) {
  const Index nc = program.cones();
  program.slack(v, s);
  left_ = s - w;
  if (const double lift = program.law().lift; lift > 0)
    for (Index k = 0; k < nc; ++k) left_[3 * k] += lift * soc::tangential(&s[3 * k]);
  program.face().force(y, force_);
  program.face().mass(v, mass_);
  force_ -= mass_;
  residual_ = std::max(left_.size() > 0 ? left_.lpNorm<Eigen::Infinity>() : 0.0, force_.lpNorm<Eigen::Infinity>());
  gap_ = y.dot(w) / static_cast<double>(degree_);
}

// D and the affine target: dy = target_ - D ds.
void InteriorPoint::weigh(const ConeProgram& program, bool couples) {
  const Index nc = program.cones();
  const double rounding = tolerances::cone_slip_rounding * gap_, slope = coupling_ * program.law().lift;
  for (Index k = 0; k < nc; ++k) {
    Cone& cone = cone_[at(k)];
    double* D = &D_[at(9 * k)];
    cone.scaling = soc::Scaling::of(&y[3 * k], &w[3 * k]);
    cone.scaling.weight(D);
    for (Index i = 0; i < 3; ++i)
      target_[3 * k + i] =
          -y[3 * k + i] - (D[i] * left_[3 * k] + D[i + 3] * left_[3 * k + 1] + D[i + 6] * left_[3 * k + 2]);
    cone.slope1 = cone.slope2 = 0;
    if (!couples) continue;
    const double size = std::sqrt(s[3 * k + 1] * s[3 * k + 1] + s[3 * k + 2] * s[3 * k + 2] + rounding);
    cone.slope1 = slope * s[3 * k + 1] / size;
    cone.slope2 = slope * s[3 * k + 2] / size;
    for (Index i = 0; i < 3; ++i) {
      D[i + 3] += D[i] * cone.slope1;
      D[i + 6] += D[i] * cone.slope2;
    }
  }
  for (Index r = 0; r < program.rays(); ++r) {
    const Index i = 3 * nc + r;
    if (program.is_equality(r)) {
      ray_weight_[r] = 1 / tolerances::cone_softness;
      target_[i] = -ray_weight_[r] * left_[i];
    } else {
      ray_weight_[r] = y[i] / w[i];
      target_[i] = -y[i] - ray_weight_[r] * left_[i];
    }
  }
}

void InteriorPoint::direct(ConeProgram& program) {
  const Index nc = program.cones();
  sum_ = y + target_;
  program.face().force(sum_, dv_);
  dv_ -= mass_;
  program.face().solve(dv_);
  program.face().slack(dv_, ds_);
  for (Index k = 0; k < nc; ++k) {
    const double *D = &D_[at(9 * k)], *d = &ds_[3 * k];
    for (Index i = 0; i < 3; ++i)
      dy_[3 * k + i] = target_[3 * k + i] - (D[i] * d[0] + D[i + 3] * d[1] + D[i + 6] * d[2]);
    dw_[3 * k] = left_[3 * k] + bend_[k] + d[0] + cone_[at(k)].slope1 * d[1] + cone_[at(k)].slope2 * d[2];
    dw_[3 * k + 1] = left_[3 * k + 1] + d[1];
    dw_[3 * k + 2] = left_[3 * k + 2] + d[2];
  }
  for (Index r = 0; r < program.rays(); ++r) {
    const Index i = 3 * nc + r;
    dy_[i] = target_[i] - ray_weight_[r] * ds_[i];
    dw_[i] = program.is_equality(r) ? 0 : left_[i] + ds_[i];
  }
}

double InteriorPoint::step_length(const ConeProgram& program) const {
  double step = std::numeric_limits<double>::infinity();
  for (Index k = 0; k < program.cones(); ++k)
    step =
        std::min({step, soc::step_to_boundary(&y[3 * k], &dy_[3 * k]), soc::step_to_boundary(&w[3 * k], &dw_[3 * k])});
  for (Index r = 0; r < program.rays(); ++r) {
    const Index i = 3 * program.cones() + r;
    if (program.is_equality(r)) continue;
    if (dy_[i] < 0) step = std::min(step, -y[i] / dy_[i]);
    if (dw_[i] < 0) step = std::min(step, -w[i] / dw_[i]);
  }
  return step;
}

double InteriorPoint::gap_after(const ConeProgram& program, double step) const {
  double sum = 0;
  for (Index i = 0; i < program.rows(); ++i) sum += (y[i] + step * dy_[i]) * (w[i] + step * dw_[i]);
  return sum / static_cast<double>(degree_);
}

// Mehrotra's corrector: target_ += W^-1 (l \ (centre e - (W dy) o (W^-1 dw))), l = W y.
void InteriorPoint::correct(const ConeProgram& program, double centre) {
  const Index nc = program.cones();
  for (Index k = 0; k < nc; ++k) {
    const soc::Scaling& W = cone_[at(k)].scaling;
    const Vec3 product = soc::product(W.times(&dy_[3 * k]), W.inverse_times(&dw_[3 * k]));
    const Vec3 x = soc::quotient(W.times(&y[3 * k]), Vec3(centre - product[0], -product[1], -product[2]));
    target_.segment<3>(3 * k) += W.inverse_times(x.data());
  }
  for (Index r = 0; r < program.rays(); ++r)
    if (const Index i = 3 * nc + r; !program.is_equality(r)) target_[i] += (centre - dy_[i] * dw_[i]) / w[i];
}

// What the shift is along that part of the predictor beyond its slope.
void InteriorPoint::bend(const ConeProgram& program, double part) {
  const double rounding = tolerances::cone_slip_rounding * gap_, share = part * program.law().lift;
  for (Index k = 0; k < program.cones(); ++k) {
    const double *own = &s[3 * k], *d = &ds_[3 * k], *D = &D_[at(9 * k)];
    const double end1 = own[1] + d[1], end2 = own[2] + d[2];
    const double size = std::sqrt(own[1] * own[1] + own[2] * own[2] + rounding);
    const double end = std::sqrt(end1 * end1 + end2 * end2 + rounding);
    bend_[k] = share * (end - size - (own[1] * d[1] + own[2] * d[2]) / size);
    for (Index i = 0; i < 3; ++i) target_[3 * k + i] -= D[i] * bend_[k];
  }
}

bool InteriorPoint::step(ConeProgram& program) {
  const Index nc = program.cones();
  const bool couples = program.law().lifts() && program.face().takes_unsymmetric();
  if (!std::isfinite(gap_) || !std::isfinite(residual_)) return false;
  for (Index k = 0; k < nc; ++k)
    if (!(soc::smallest(&y[3 * k]) > 0 && soc::smallest(&w[3 * k]) > 0)) return false;
  weigh(program, couples);
  if (!program.face().factorize(D_, ray_weight_, !couples)) return false;
  bend_.setZero();
  direct(program);
  const double affine = std::min(1.0, step_length(program));
  const double share = std::max(0.0, gap_after(program, affine) / gap_);
  double centre = std::clamp(share * share * share, tolerances::cone_least_centre, 1.0);
  if (couples) {
    const double ratio = residual_ * program.start() / gap_;
    centre = last_step_ < damping::blocked
                 ? 1
                 : std::max(centre, std::min(damping::of_residual * ratio, damping::most_of_residual));
    bend(program, affine);
  }
  correct(program, gap_ * centre);
  direct(program);
  const double step = std::min(1.0, tolerances::cone_to_boundary * step_length(program));
  if (!(step > 0) || !dv_.allFinite()) return false;
  v += step * dv_;
  y += step * dy_;
  w += step * dw_;
  const double before = residual_;
  measure(program);
  const bool idle =
      step > damping::whole && residual_ > damping::left_over * before && residual_ * program.start() > gap_;
  if (step < damping::blocked || idle)
    coupling_ *= damping::less;
  else if (step > damping::free_step)
    coupling_ = std::min(1.0, damping::more * coupling_ + damping::little);
  last_step_ = step;
  return true;
}

// The part of y that moves the bodies is taken out of it: u = y - D G (M + G'D G)^-1 G'y, D large where y is.
bool InteriorPoint::proves_infeasible(ConeProgram& program, double reach, Vector& u) {
  const Index nc = program.cones();
  if (!(y.dot(program.h()) > 0)) return false;
  weigh(program, false);
  if (!program.face().factorize(D_, ray_weight_, true)) return false;
  u = y / y.lpNorm<Eigen::Infinity>();
  for (int pass = 0; pass < 4; ++pass) {
    program.face().force(u, dv_);
    program.face().solve(dv_);
    program.face().slack(dv_, ds_);
    for (Index k = 0; k < nc; ++k) {
      const double *D = &D_[at(9 * k)], *d = &ds_[3 * k];
      for (Index i = 0; i < 3; ++i) u[3 * k + i] -= D[i] * d[0] + D[i + 3] * d[1] + D[i + 6] * d[2];
    }
    for (Index r = 0; r < program.rays(); ++r) u[3 * nc + r] -= ray_weight_[r] * ds_[3 * nc + r];
  }
  for (Index k = 0; k < nc; ++k) u.segment<3>(3 * k) = soc::projected(u.segment<3>(3 * k));
  for (Index r = 0; r < program.rays(); ++r)
    if (!program.is_equality(r)) u[3 * nc + r] = std::max(0.0, u[3 * nc + r]);
  // |G'u| in the metric of M^-1, with M between its value and that of the factor: f'H^-1 f <= f'M^-1 f.
  program.face().force(u, force_);
  std::fill(D_.begin(), D_.end(), 0.0);
  ray_weight_.setZero();
  if (!program.face().factorize(D_, ray_weight_, true)) return false;
  dv_ = force_;
  program.face().solve(dv_);
  const double motion = std::sqrt(std::max(0.0, force_.dot(dv_)));
  return u.dot(program.h()) > reach * motion;
}

}  // namespace zwang
