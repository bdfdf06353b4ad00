#include <zwang/solvers/friction/interior_point.h>

#include <algorithm>
#include <array>
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
// How the central path is followed.
namespace path {
// Steps end so near it, in units of the way to the boundary.
constexpr double near = 0.3;
// The logarithm by which the gap falls: tried at first, at most, and after a correction on the spot; where a step
// fails, a part of it is tried, and where the first try does not fail, twice as much the next time.
constexpr double first = 0.6, most = 6, again = 0.2, less = 0.7;
constexpr int most_tries = 14;
// Directions with the curvature along the one before, by the same factor.
constexpr int most_bends = 5;
// What is nearer to the path than this is not corrected on the spot: at a fold that leads away.
constexpr double centred = 0.2;
// Of a gap over a load, what rounds the slip off.
constexpr double rounding = 0.7;
}  // namespace path

using Pack = lanes::PackOf<1>;
using lanes::Threes, soc::Three;
constexpr Index few = Pack::lanes;

// A few cones of x from cone k on, one a lane, so that a loop over cones takes a fraction of its time; behind the last
// of nc, points inside. The numbers are those of one cone after the other, to the bit.
[[gnu::always_inline]] inline Three<Pack> cones(const Vector& x, Index k, Index nc) {
  if (k + few <= nc) return Threes::load(&x[3 * k]).x;
  std::array<double, 3 * few> own = {};
  for (std::size_t i = 0; i < own.size(); i += 3) own[i] = 1;
  std::copy(x.data() + 3 * k, x.data() + 3 * nc, own.begin());
  return Threes::load(own.data()).x;
}
[[gnu::always_inline]] inline void set_cones(const Three<Pack>& from, Index k, Index nc, Vector& x) {
  if (k + few <= nc) return Threes{from}.store(&x[3 * k]);
  std::array<double, 3 * few> own;
  Threes{from}.store(own.data());
  std::copy_n(own.begin(), 3 * (nc - k), &x[3 * k]);
}
[[gnu::always_inline]] inline Three<Pack> operator+(const Three<Pack>& a, const Three<Pack>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
[[gnu::always_inline]] inline Three<Pack> operator-(const Three<Pack>& a, const Three<Pack>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
[[gnu::always_inline]] inline Pack norm(const Three<Pack>& x) {
  return root(x[0] * x[0] + (x[1] * x[1] + x[2] * x[2]));
}
// |s_t|, rounded off.
[[gnu::always_inline]] inline Pack slip(const Pack& s1, const Pack& s2, const Pack& rounding) {
  return root(s1 * s1 + s2 * s2 + rounding);
}

}  // namespace

// On the central path of a gap of about size start(). What is farther open at v = 0 starts there: from w = size start()
// a hand that hardly presses, whose other contacts are 1e7 times as far away, took 40 steps to let them go.
void InteriorPoint::begin(ConeProgram& program, double size) {
  const Index m = program.rows(), n = program.face().unknowns(), nc = program.cones();
  for (Vector* x : {&y, &w, &s, &left_, &ds_, &dy_, &dw_, &target_, &sum_}) x->setZero(m);
  for (Vector* x : {&v, &dv_, &force_, &mass_, &aim_}) x->setZero(n);
  rounding_.setZero(lanes::round_up(nc));
  const bool couples = program.couples();
  ray_weight_.setZero(program.rays());
  D_.assign(at(9 * nc), 0);
  few_.resize(at((nc + few - 1) / few));
  degree_ = 2 * nc;
  const double first = size * program.start();
  program.slack(v, s);
  for (Index k = 0; k < nc; ++k) {
    double *Y = &y[3 * k], *W = &w[3 * k], *slack = &s[3 * k];
    Y[0] = first * program.tilt(k);
    W[0] = first * std::max(1.0, 1 / program.tilt(k));
    slack[0] += program.law().shift(slack);
    if (couples) slack[0] = std::max(slack[0], W[0] + soc::tangential(slack));
    if (!((couples || soc::smallest(slack) > W[0]) && soc::largest(slack) < farthest * first)) continue;
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
  bend_.setZero(rounding_.size());
  if (program.is_dense() && !couples) program.face().force(y, v);
  let_go(program);
}

void InteriorPoint::measure_rows(const ConeProgram& program) {
  left_ = s - w;
  if (const double lift = program.law().lift; lift > 0)
    for (Index k = 0; k < program.cones(); k += few) {
      const Three<Pack> own = cones(s, k, program.cones());
      const Pack shift = Pack(lift) * slip(own[1], own[2], Pack::load(&rounding_[k]));
      for (Index l = 0; l < std::min(few, program.cones() - k); ++l) left_[3 * (k + l)] += shift.data()[l];
    }
}

void InteriorPoint::measure(ConeProgram& program) {
  program.slack(v, s);
  measure_rows(program);
  program.face().force(y, force_);
  program.face().mass(v, mass_);
  force_ -= mass_;
  residual_ = std::max(left_.size() > 0 ? left_.lpNorm<Eigen::Infinity>() : 0.0, force_.lpNorm<Eigen::Infinity>());
  gap_ = y.dot(w) / static_cast<double>(degree_);
}

// D and the slope of the shift. False where y or w is outside the cones.
bool InteriorPoint::weigh(const ConeProgram& program, bool couples) {
  const Index nc = program.cones();
  const double slope = coupling_ * program.law().lift;
  bool inside = true;
  for (Index k = 0; k < nc; k += few) {
    Few own{soc::Scaling<Pack>::of(cones(y, k, nc).data(), cones(w, k, nc).data()), Pack(0), Pack(0)};
    if (couples) {
      const Three<Pack> slack = cones(s, k, nc);
      const Pack rounding = path_ > 0 ? Pack::load(&rounding_[k]) : Pack(tolerances::cone_slip_rounding * gap_);
      const Pack share = slope / slip(slack[1], slack[2], rounding);
      own.slope1 = share * slack[1];
      own.slope2 = share * slack[2];
    }
    few_[at(k / few)] = own;
    const std::array<Pack, 9> D = couples ? own.weight() : own.scaling.weight();
    for (Index l = 0; l < std::min(few, nc - k); ++l) {
      inside = inside && own.scaling.a0.data()[l] > 0 && own.scaling.eta.data()[l] > 0 &&
               own.scaling.inverse_eta.data()[l] > 0;
      for (std::size_t i = 0; i < 9; ++i) D_[at(9 * (k + l)) + i] = D[i].data()[l];
    }
  }
  for (Index r = 0; r < program.rays(); ++r) {
    const Index i = 3 * nc + r;
    ray_weight_[r] = program.is_equality(r) ? 1 / tolerances::cone_softness : y[i] / w[i];
  }
  return inside;
}

// The affine target: dy = target_ - D ds.
void InteriorPoint::aim(const ConeProgram& program) {
  const Index nc = program.cones();
  for (Index k = 0; k < nc; k += few) {
    const Three<Pack> own = cones(y, k, nc);
    const Three<Pack> back = soc::multiply(few_[at(k / few)].scaling.weight(), cones(left_, k, nc));
    set_cones(Three<Pack>{-own[0], -own[1], -own[2]} - back, k, nc, target_);
  }
  for (Index r = 0; r < program.rays(); ++r) {
    const Index i = 3 * nc + r;
    target_[i] = (program.is_equality(r) ? 0 : -y[i]) - ray_weight_[r] * left_[i];
  }
}

void InteriorPoint::direct(ConeProgram& program) {
  const Index nc = program.cones();
  sum_ = y + target_;
  program.face().force(sum_, dv_);
  dv_ -= mass_ + aim_;
  program.face().solve(dv_);
  program.face().slack(dv_, ds_);
  for (Index k = 0; k < nc; k += few) {
    const Few& own = few_[at(k / few)];
    const Three<Pack> d = cones(ds_, k, nc), left = cones(left_, k, nc);
    set_cones(cones(target_, k, nc) - soc::multiply(own.weight(), d), k, nc, dy_);
    const Pack normal = left[0] + Pack::load(&bend_[k]) + d[0] + own.slope1 * d[1] + own.slope2 * d[2];
    set_cones({normal, left[1] + d[1], left[2] + d[2]}, k, nc, dw_);
  }
  for (Index r = 0; r < program.rays(); ++r) {
    const Index i = 3 * nc + r;
    dy_[i] = target_[i] - ray_weight_[r] * ds_[i];
    dw_[i] = program.is_equality(r) ? 0 : left_[i] + ds_[i];
  }
}

// Up to the boundary, or a whole step and a little. A cone whose end is inside has no say.
double InteriorPoint::step_length(const ConeProgram& program) const {
  double step = 1 / tolerances::cone_to_boundary;
  const auto bound = [&step](const double* x, const double* d) {
    const double end[3] = {x[0] + step * d[0], x[1] + step * d[1], x[2] + step * d[2]};
    if (!(end[0] > 0 && end[0] * end[0] > end[1] * end[1] + end[2] * end[2]))
      step = std::min(step, soc::step_to_boundary(x, d));
  };
  for (Index k = 0; k < program.cones(); ++k) {
    bound(&y[3 * k], &dy_[3 * k]);
    bound(&w[3 * k], &dw_[3 * k]);
  }
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
  for (Index k = 0; k < nc; k += few) {
    const soc::Scaling<Pack>& W = few_[at(k / few)].scaling;
    const Three<Pack> product =
        soc::product(W.times(cones(dy_, k, nc).data()), W.inverse_times(cones(dw_, k, nc).data()));
    const Three<Pack> x =
        soc::quotient<Pack>(W.times(cones(y, k, nc).data()), {Pack(centre) - product[0], -product[1], -product[2]});
    set_cones(cones(target_, k, nc) + W.inverse_times(x.data()), k, nc, target_);
  }
  for (Index r = 0; r < program.rays(); ++r)
    if (const Index i = 3 * nc + r; !program.is_equality(r)) target_[i] += (centre - dy_[i] * dw_[i]) / w[i];
}

// What the shift is along that part of the predictor beyond its slope.
void InteriorPoint::bend(const ConeProgram& program, double part) {
  const Index nc = program.cones();
  for (Index k = 0; k < nc; k += few) {
    const Few& own = few_[at(k / few)];
    const Three<Pack> from = cones(s, k, nc), d = cones(ds_, k, nc);
    const Pack rounding = path_ > 0 ? Pack::load(&rounding_[k]) : Pack(tolerances::cone_slip_rounding * gap_);
    const Pack size = slip(from[1], from[2], rounding), end = slip(from[1] + d[1], from[2] + d[2], rounding);
    const Pack beyond = Pack(part) * (Pack(program.law().lift) * (end - size) -
                                      (own.slope1 * d[1] + own.slope2 * d[2]) / Pack(coupling_));
    beyond.store(&bend_[k]);
    const std::array<Pack, 9> D = own.weight();
    set_cones(cones(target_, k, nc) - Three<Pack>{D[0] * beyond, D[1] * beyond, D[2] * beyond}, k, nc, target_);
  }
}

// How far the iterate is from the path at that gap, in units of the way to the boundary.
double InteriorPoint::off_path(const ConeProgram& program, double gap) const {
  double worst = 0;
  const Index nc = program.cones();
  for (Index k = 0; k < nc; k += few) {
    const Three<Pack> Y = cones(y, k, nc), W = cones(w, k, nc), share = cones(left_share_, k, nc);
    const Pack least_y = soc::smallest(Y.data()), least_w = soc::smallest(W.data());
    const soc::Scaling<Pack> scaling = soc::Scaling<Pack>::of(Y.data(), W.data());
    const Three<Pack> l = scaling.times(Y.data());
    const Three<Pack> off =
        cones(left_, k, nc) - Three<Pack>{Pack(gap) * share[0], Pack(gap) * share[1], Pack(gap) * share[2]};
    Three<Pack> product = soc::product(l, l);
    product[0] -= Pack(gap);
    const Pack of_gap = norm(product) / Pack(gap),
               of_left = norm(scaling.inverse_times(off.data())) / Pack(std::sqrt(gap));
    for (Index i = 0; i < std::min(few, nc - k); ++i) {
      if (!(least_y.data()[i] > 0 && least_w.data()[i] > 0)) return infinity;
      worst = std::max({worst, of_gap.data()[i], of_left.data()[i]});
    }
  }
  for (Index r = 0; r < program.rays(); ++r) {
    const Index i = 3 * program.cones() + r;
    if (program.is_equality(r)) continue;
    if (!(y[i] > 0 && w[i] > 0)) return infinity;
    worst = std::max({worst, std::abs(y[i] * w[i] / gap - 1), std::abs(left_[i] - gap * left_share_[i]) / w[i]});
  }
  return worst;
}

// |s_t| as the path at that gap has it.
void InteriorPoint::round_off(const ConeProgram& program, double gap) {
  for (Index k = 0; k < program.cones(); ++k) {
    const double least = path::rounding * gap / begun_y_[3 * k];
    rounding_[k] = least * least;
  }
}

// From where the step began to the path at that gap: Newton's direction, or one with the curvature along the last.
void InteriorPoint::head_for(ConeProgram& program, double gap, bool curved) {
  round_off(program, gap);
  move(program, 0);
  left_ -= gap * left_share_;
  aim_ = gap * force_share_;
  bend_.setZero();
  if (!curved)
    for (Vector* x : {&dy_, &dw_}) x->setZero();
  aim(program);
  if (curved) bend(program, 1);
  correct(program, gap);
  direct(program);
}

bool InteriorPoint::reaches(ConeProgram& program, double gap) {
  head_for(program, gap, false);
  for (int bends = 0; bends < path::most_bends; ++bends) {
    head_for(program, gap, true);
    move(program, 1);
    const double off = off_path(program, gap);
    if (off < path::near) return true;
    if (bends > 0 && !std::isfinite(off)) return false;  // outside the cones still
  }
  return false;
}

// By a part of the direction; v stays where it is until take().
void InteriorPoint::move(const ConeProgram& program, double step) {
  y = begun_y_;
  w = begun_w_;
  s = begun_s_;
  if (step > 0) {
    y += step * dy_;
    w += step * dw_;
    s += step * ds_;
  }
  measure_rows(program);
}

bool InteriorPoint::take(ConeProgram& program, double step, double next_width) {
  v += step * dv_;
  measure(program);
  width_ = next_width;
  return true;
}

bool InteriorPoint::follow(ConeProgram& program) {
  if (path_ == 0) {
    path_ = gap_;
    width_ = path::first;
    left_share_ = left_ / path_;
    force_share_ = force_ / path_;
  }
  begun_y_ = y;
  begun_w_ = w;
  begun_s_ = s;
  round_off(program, path_);
  measure_rows(program);
  const double before = off_path(program, path_);
  weigh(program, true);
  if (!program.factorize(D_, ray_weight_, false)) return false;
  sees_end_ = path_ <= tolerances::cone_in_sight * program.start() * program.start();
  if (sees_end_) {
    head_for(program, 0, false);
    head_for(program, 0, true);
    v_end = v + dv_;
    y_end = y + dy_;
  }
  double width = std::min(width_, path::most);
  for (int tries = 0; tries < path::most_tries; ++tries, width *= path::less) {
    const double gap = path_ * std::exp(-width);
    if (!reaches(program, gap)) continue;
    path_ = gap;
    return take(program, 1, tries == 0 ? 2 * width : width / path::less);
  }
  head_for(program, path_, false);
  for (double step = 1; before > path::centred && step > tolerances::cone_least_correction; step *= 0.5) {
    move(program, step);
    if (off_path(program, path_) < before * (1 - 0.1 * step)) return take(program, step, path::again);
  }
  move(program, 0);
  return false;
}

void InteriorPoint::let_go(ConeProgram& program) {
  forget_path();
  rounding_.setZero();
  aim_.setZero();
  coupling_ = last_step_ = 1;
  measure(program);
}

bool InteriorPoint::step(ConeProgram& program) {
  const bool couples = program.couples();
  if (!std::isfinite(gap_) || !std::isfinite(residual_)) return false;
  if (!weigh(program, couples)) return false;
  if (!program.factorize(D_, ray_weight_, !couples)) return false;
  bend_.setZero();
  aim(program);
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
bool InteriorPoint::proves_infeasible(ConeProgram& program, Vector& u) {
  const Index nc = program.cones();
  if (!(y.dot(program.h()) > 0)) return false;
  weigh(program, false);
  if (!program.factorize(D_, ray_weight_, true)) return false;
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
  program.cut(u);
  program.face().force(u, force_);
  dv_ = force_;
  program.divide_by_mass(dv_);
  const double motion = std::sqrt(std::max(0.0, force_.dot(dv_)));
  const double gain = u.dot(program.h()),
               rounding = tolerances::proof_rounding * u.cwiseProduct(program.h()).lpNorm<1>();
  return gain > std::max(rounding, tolerances::out_of_reach * program.reach() * motion);
}

}  // namespace zwang
