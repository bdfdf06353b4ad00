#include <zwang/solvers/newton/augmented_lagrangian.h>

#include <algorithm>
#include <cmath>

namespace zwang {
namespace {

constexpr int least_patience = 300;  // steps, or as many as there are rows: a heap of 3,000 may need a thousand

}  // namespace

void AugmentedLagrangian::begin(const Problem& p, const SolveOptions& options, const Deadline& deadline,
                                double penalty) {
  problem_ = &p;
  factor_.analyze(p.M, rows.g, options, deadline);
  const Index n = factor_.size(), k = rows.rows();
  factor_.list(p.M, rows.g, mass_, place_);
  for (Vector* v : {&d, &step_, &force_, &product_, &work_}) v->setZero(n);
  for (Vector* v : {&term_, &change_, &weight}) v->setZero(k);
  h_ = rows.exact_h.cwiseMax(Real(-tolerances::horizon)).cast<double>();
  part_.resize(at(factor_.parts()));
  warm_rows_.multipliers(p, rows, options.warm_start, l);
  if (!(l.lpNorm<1>() <= tolerances::warm_start)) l.setZero();
  s = penalty;
  rate = 1;
}

bool AugmentedLagrangian::rests() const {
  for (Index i = 0; i < rows.rows(); ++i)
    if (is_equality(i) ? rows.exact_h[i] != 0 : rows.exact_h[i] > 0) return false;
  return true;
}

// To the last bit. An earlier frame's multipliers would be worked off to tiny numbers, not to 0.
void AugmentedLagrangian::write_rest(Solution& solution) {
  l.setZero();
  write(d, l, solution);
  solution.redundant.assign(rows.idle.begin(), rows.idle.end());
  solution.status = Status::solved;
}

void AugmentedLagrangian::count(const Vector& multipliers, const SolveOptions& options, Solution& solution) const {
  ++solution.iterations;
  if (!options.observe) return;
  write(d, multipliers, solution);
  options.observe(solution.iterations, solution.z, solution.lambda);
}

bool AugmentedLagrangian::factorize(const Deadline& deadline) {
  return factor_.factorize(problem_->M, rows.g, {weight.data(), at(weight.size())}, deadline);
}

double AugmentedLagrangian::mass_norm(const Vector& x) {
  multiply(mass_, x, work_);
  return std::sqrt(std::max(0.0, work_.dot(x)));
}

double AugmentedLagrangian::force_norm(const Vector& f) {
  columns_.setZero(problem_->size());
  for (Index j = 0; j < unknowns(); ++j) columns_[factor_.column(static_cast<int>(j))] = f[j];
  rows.factor.solve_lower(columns_);
  return columns_.norm();
}

double AugmentedLagrangian::distance(const Vector& from) {
  step_ = d - from;
  return mass_norm(step_);
}

// In a wall almost all rows push in the end, and from d = 0 the method takes ten steps and more to find that out.
AugmentedLagrangian::Held AugmentedLagrangian::hold_near(const Deadline& deadline) {
  for (Index i = 0; i < rows.rows(); ++i) weight[i] = is_equality(i) || h_[i] > -1 ? hold_penalty : 0;
  const Held held = hold(deadline);
  if (held != Held::none) return held;
  d.setZero();
  l.setZero();
  rate = 1;
  return held;
}

void AugmentedLagrangian::hold_pushing(const Vector& z, const Vector& lambda, const Deadline& deadline) {
  const auto read = [&] {
    for (Index j = 0; j < unknowns(); ++j) {
      const Index column = factor_.column(static_cast<int>(j));
      d[j] = std::ldexp(z[column] - problem_->z_u[column], -rows.exponent);
    }
    for (Index i = 0; i < rows.rows(); ++i) {
      l[i] = rows.unit_multiplier(i, lambda[rows.row[at(i)]]);
      if (!is_equality(i) && !(l[i] > -violation(i))) l[i] = 0;
      weight[i] = is_equality(i) || l[i] > 0 ? hold_penalty : 0;
    }
  };
  read();
  if (hold(deadline) != Held::none) return;
  read();
  rate = 1;
}

// The rows that have weight, as if they were equality rows. They may repeat each other: where the shortest l pulls on
// some, another of the same G'l mostly does not. A pass that begins with those well above zero comes nearer to it,
// without another factor.
AugmentedLagrangian::Held AugmentedLagrangian::hold(const Deadline& deadline) {
  constexpr double above = 3;
  constexpr int passes = 4;
  if (!factorize(deadline)) return Held::none;
  double length = infinity, pull = 0, push = 0;
  Index pulling = 0;
  bool settles = false;
  for (int pass = 0; pass < passes; ++pass) {
    multiply(mass_, d, product_);
    step_ = -product_;
    for (Index i = 0; i < rows.rows(); ++i) {
      if (weight[i] == 0) continue;
      if (!is_equality(i) && l[i] < 0) l[i] *= -above;
      change_[i] = violation(i);
      add(i, l[i] + weight[i] * change_[i], step_);
    }
    solve(step_);
    d += step_;
    pull = push = 0;
    pulling = 0;
    for (Index i = 0; i < rows.rows(); ++i) {
      if (weight[i] != 0) l[i] += weight[i] * (change_[i] - dot(i, step_));
      push += std::max(l[i], 0.0);
      if (is_equality(i) || l[i] >= 0) continue;
      pull -= l[i];
      ++pulling;
    }
    const double last = length;
    length = mass_norm(step_);
    settles = settles || (pass > 1 && length <= tolerances::newton_slow * last);
    // What is left after a few passes tells the slowest direction, unless it is rounding.
    if (last < infinity && last > tolerances::newton_nothing * rows.free_norm) rate = length / last;
    if (pulling == 0 && settles) break;
  }
  if (!(pull <= tolerances::newton_few_pull * push)) return Held::none;
  for (Index i = 0; i < rows.rows(); ++i)
    if (!is_equality(i)) l[i] = std::max(l[i], 0.0);
  scale = std::max(rows.free_norm, mass_norm(d));
  const bool many = 100 * pulling > rows.rows();
  s = settles && !many ? hold_penalty : tolerances::newton_hold;
  if (many) return Held::many_left;
  return settles ? Held::known : Held::few_left;
}

Status AugmentedLagrangian::minimize(double last_move, const SolveOptions& options, const Deadline& deadline,
                                     Solution& solution) {
  const int most_steps = std::max(least_patience, static_cast<int>(rows.rows()));
  for (bool settled = false; !settled;) {
    linearize();
    const bool may_go_on = solution.iterations < most_steps && solution.iterations < options.max_iterations;
    const bool factorized = may_go_on && factorize(deadline);
    if (deadline.passed()) return Status::time_limit;
    if (solution.iterations >= options.max_iterations) return Status::iteration_limit;
    if (!factorized) return Status::numerical_failure;
    const double length = step();
    if (!std::isfinite(length)) return Status::numerical_failure;
    settled = length <= tolerances::newton_inner * std::min(last_move, scale) ||
              length <= tolerances::newton_nothing * scale || keeps_rows();
    count(term_, options, solution);
  }
  return Status::solved;
}

void AugmentedLagrangian::linearize() {
  multiply(mass_, d, product_);
  force_ = -product_;
  for (Index i = 0; i < rows.rows(); ++i) {
    term_[i] = l[i] + s * violation(i);
    weight[i] = is_equality(i) || term_[i] > 0 ? s : 0;
    if (weight[i] != 0) add(i, term_[i], force_);
  }
}

double AugmentedLagrangian::step() {
  step_ = force_;
  solve(step_);
  for (Index i = 0; i < rows.rows(); ++i) change_[i] = dot(i, step_);
  multiply(mass_, step_, product_);
  const double length = std::sqrt(std::max(0.0, product_.dot(step_)));
  search();
  for (Index j = 0; j < step_.size(); ++j) step_[j] *= part_of(j).step;
  d += step_;
  scale = std::max(rows.free_norm, mass_norm(d));
  return length;
}

// The step of each part to where its derivative along step_ vanishes: a piecewise linear, increasing function, so
// Newton's method within a bracket ends after a few of its pieces.
void AugmentedLagrangian::search() {
  for (Part& part : part_) part = {.high = infinity};
  for (Index j = 0; j < step_.size(); ++j) {
    Part& part = part_of(j);
    part.linear += product_[j] * d[j];  // product_ = M step
    part.quadratic += product_[j] * step_[j];
    part.zero += force_[j] * step_[j];  // -derivative at 0
  }
  int open = static_cast<int>(part_.size());
  for (int round = 0; round < 60 && open > 0; ++round) {
    for (Part& part : part_) {
      part.derivative = part.linear + part.step * part.quadratic;
      part.slope = part.quadratic;
    }
    for (Index i = 0; i < rows.rows(); ++i) {
      Part& part = part_[at(factor_.part_of_row(static_cast<int>(i)))];
      if (part.done) continue;
      const double term = term_[i] - s * part.step * change_[i];
      if (!is_equality(i) && !(term > 0)) continue;
      part.derivative -= term * change_[i];
      part.slope += s * change_[i] * change_[i];
    }
    for (Part& part : part_) {
      if (part.done) continue;
      part.done =
          std::abs(part.derivative) <= tolerances::newton_line_search * std::abs(part.zero) || !(part.slope > 0);
      if (part.done) {
        --open;
        continue;
      }
      (part.derivative > 0 ? part.high : part.low) = part.step;
      const double newton = part.step - part.derivative / part.slope;
      if (newton > part.low && newton < part.high)
        part.step = newton;
      else
        part.step = part.high < infinity ? 0.5 * (part.low + part.high) : 2 * part.step;
    }
  }
}

bool AugmentedLagrangian::keeps_rows() const {
  for (const Part& part : part_)
    if (part.step != 1) return false;
  for (Index i = 0; i < rows.rows(); ++i)
    if (!is_equality(i) && (weight[i] != 0) != (term_[i] - s * change_[i] > 0)) return false;
  return true;
}

double AugmentedLagrangian::step_multipliers() {
  double gain = 0;
  for (Index i = 0; i < rows.rows(); ++i) {
    const double before = l[i], term = before + s * violation(i);
    l[i] = is_equality(i) ? term : std::max(0.0, term);
    if (is_equality(i) || l[i] > before) gain += (l[i] - before) * h_[i];
  }
  return gain;
}

void AugmentedLagrangian::residuals(const RealVector& far_d, const RealVector& far_l, RealVector& force,
                                    RealVector& violation) const {
  const Problem& p = *problem_;
  force.setZero(unknowns());
  violation.resize(rows.rows());
  for (const MatrixEntry& e : mass_) force[e.row] -= Real(e.value) * far_d[e.column];
  for (Index i = 0; i < rows.rows(); ++i) {
    const Real norm = rows.row_norm[i], factor = far_l[i] / norm;
    Real sum = 0;
    for (RowMatrix::InnerIterator it(p.J, rows.row[at(i)]); it; ++it) {
      if (it.value() == 0) continue;
      const int j = factor_.position(static_cast<int>(it.col()));
      if (j < 0) continue;  // faint
      sum += Real(it.value()) * far_d[j];
      force[j] += Real(it.value()) * factor;
    }
    violation[i] = rows.exact_h[i] - sum / norm;
  }
}

}  // namespace zwang
