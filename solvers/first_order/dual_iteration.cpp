#include <zwang/solvers/first_order/dual_iteration.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <bit>
#include <utility>

#include <zwang/solvers/form/bound_inside.h>
#include <zwang/solvers/form/unit_rows.h>

namespace zwang {
namespace {

constexpr double affordable = 4;  // of the work so far: a look
constexpr double widest = 8;      // motions that open rows by 1
constexpr int first_look = 100;   // steps, ten times what one takes, where the iterate is not near enough before

}  // namespace

bool DualIteration::begin(const Problem& problem, const SolveOptions& options, Solution& solution) {
  problem_ = &problem;
  options_ = &options;
  solution_ = &solution;
  deadline_ = Deadline(options.time_limit);
  if (!program.build(problem, options, solution)) return false;
  program.warm_multipliers(problem, options.warm_start, lambda);
  program.motion(lambda, y);
  marked_.setZero(program.rows());
  prover_ = begin_prover(problem, options);
  if (prover_ && repeats_equalities(program)) solution.error_bound = infinity, prover_ = nullptr;
  looks_ = prover_ && std::ranges::find(problem.kind, RowKind::equality) == problem.kind.end();
  last_left_ = std::numeric_limits<double>::infinity();
  solution.status = Status::iteration_limit;
  return true;
}

bool DualIteration::goes_on(int limit) {
  if (runs_off()) {
    solution_->status = Status::infeasible;
    sharpening_.run(program, drift_);
    program.write_certificate(*problem_, drift_, *solution_);
    return false;
  }
  if (solution_->iterations >= std::min(limit, options_->max_iterations)) return false;
  if (deadline_.passed()) solution_->status = Status::time_limit;
  return solution_->status == Status::iteration_limit;
}

// On a problem without a solution lambda runs off along a Farkas vector, while y settles. Looked for after 16, 32, 64,
// ... steps.
bool DualIteration::runs_off() {
  const auto steps = static_cast<unsigned>(solution_->iterations);
  if (steps < 16 || !std::has_single_bit(steps)) return false;
  drift_ = lambda - marked_;
  if (proves_infeasible(program, drift_, motion_)) return true;
  marked_ = lambda;
  return false;
}

bool DualIteration::step_done(double left) {
  ++solution_->iterations;
  if (options_->observe) {
    write();
    options_->observe(solution_->iterations, solution_->z, solution_->lambda);
  }
  if (!prover_ || (looks_ && solution_->iterations < first_look && left > options_->accuracy)) return false;
  const double own = price(), work = this->work(), all = looks_ && own == 0 ? outside() : own;
  const bool ends = looks_ && ends_before(all / work, left);
  if (ends || all > affordable * work || !prover_->is_due(work, left, own)) return false;
  if (own > 0) return holds(true);
  write();
  return prover_->holds(solution_->lambda, *solution_);
}

// Would the method, as it converges, end before a look of that part of its work so far has paid?
bool DualIteration::ends_before(double part, double left) {
  const double shrinks = left / std::exchange(last_left_, left), asked = options_->tolerance;
  if (left <= asked || !(left <= options_->accuracy)) return left <= asked;
  return shrinks < 1 && part * solution_->iterations > std::log(asked / left) / std::log(shrinks);
}

// Near enough y needs not be moved.
void DualIteration::end() {
  const double own = price();
  if (!looks_ || solution_->status != Status::solved || !holds(own > 0 && own <= work())) write();
}

// Of holds(), in multiplications; 0 where Promise's look is the shorter one: many rows.
double DualIteration::price() const {
  if (!looks_) return 0;
  constexpr double sweeps = 40, pair = 4, lanes = 8;
  const auto k = static_cast<double>((lambda.array() > 0).count()), g = static_cast<double>(program.G.nonZeros());
  const double own = sweeps * g + k * k * (pair + k / (6 * lanes));
  return own <= outside() ? own : 0;
}

// To the nearest point of the rows that push, by a dense factor of their Delassus matrix. motion_ opens each by one.
// Tried: to exchange rows that are violated then, or pull, as Promise does. No look held that did not without.
bool DualIteration::move() {
  constexpr int most_passes = 8;
  const Vector& h = program.h;
  const double rounding = tolerances::rank * std::numeric_limits<double>::epsilon() * program.scale(y);
  pushing_.clear();
  for (Index i = 0; i < program.rows(); ++i)
    if (lambda[i] > 0 && lambda[i] > program.dot(i, y) - h[i])
      pushing_.push_back(i);
    else
      near_lambda_[i] = 0;
  const Index k = std::ssize(pushing_);
  if (gram_.rows() < k) gram_.resize(k, k);
  Eigen::Ref<Matrix> gram = gram_.topLeftCorner(k, k);
  for (Index a = 0; a < k; ++a) {
    motion_.setZero(program.size());
    program.add(pushing_[at(a)], 1, motion_);
    for (Index b = a; b < k; ++b) gram(b, a) = program.dot(pushing_[at(b)], motion_);
    gram(a, a) += tolerances::promise_softness;
  }
  const Eigen::LLT<Eigen::Ref<Matrix>> factor(gram);
  if (k == 0 || factor.info() != Eigen::Success) return false;
  least_ = gram.diagonal().minCoeff();
  if (part_.size() < k) part_.resize(k);
  auto part = part_.head(k);
  part.setOnes();
  factor.solveInPlace(part);
  motion_.setZero(program.size());
  for (Index a = 0; a < k; ++a) program.add(pushing_[at(a)], part[a], motion_);
  for (int pass = 0;; ++pass) {
    program.motion(near_lambda_, near_y_);
    for (Index a = 0; a < k; ++a) part[a] = h[pushing_[at(a)]] - program.dot(pushing_[at(a)], near_y_);
    if (pass == most_passes || !(part.lpNorm<Eigen::Infinity>() > rounding)) return true;
    factor.solveInPlace(part);
    for (Index a = 0; a < k; ++a) near_lambda_[pushing_[at(a)]] += part[a];
  }
}

// What promise.h does, of rows without equality rows, with what is at hand, and the bound is had inside
// (bound_inside.h). It takes as long as a few sweeps, where to state the rows anew takes as long as a small solve.
// Where no motion opens them the next looks are Promise's.
bool DualIteration::holds(bool moves) {
  near_lambda_ = lambda;
  near_y_ = y;
  motion_.setZero(program.size());
  least_ = 0;
  if (moves && !move()) return false;
  const Vector& h = program.h;
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const double length = near_y_.norm(), free = program.free.norm(), tied = program.factor.tied();
  const double size = std::max(free, length), rounding = eps * std::sqrt(tied) * size,
               hidden = tolerances::rank * rounding, touching = tolerances::promise_touching * size;
  double pulled = 0, missed = 0, open = infinity, opened = infinity;
  near_.clear();
  near_.reserve(at(program.rows()));
  for (Index i = 0; i < program.rows(); ++i) {
    const double slack = program.dot(i, near_y_) - h[i];
    if (near_lambda_[i] == 0)
      open = std::min(open, slack);
    else
      missed = std::max(missed, std::abs(slack));
    pulled += std::max(0.0, -near_lambda_[i]);
    near_lambda_[i] = std::max(0.0, near_lambda_[i]);
    near_.push_back({i, hidden - slack, hidden + slack, near_lambda_[i], slack + h[i]});
    if (near_lambda_[i] > 0 || slack <= touching) opened = std::min(opened, slack + h[i]);
  }
  pulled += tolerances::rank * eps * near_lambda_.lpNorm<1>();
  // Rows that are clearly independent are met by a point that is nearer to y than others.
  const double rows = std::sqrt(static_cast<double>(program.rows())),
               across = tolerances::pivot_margin * rows / least_ * (tolerances::violation * rounding + missed);
  double bound = pulled + 2 * across;
  if (!(least_ * least_ > tolerances::clear_pivot && open > across + hidden)) {
    const bool opens = widest * opened > length;  // a body at rest by y itself
    if (!opens) open_all(program, near_, touching, motion_);
    bound = bound_inside(near_, opens ? length : motion_.norm(), pulled, tolerances::violation * eps);
  }
  bound += eps * std::max<double>(tolerances::rank, tolerances::violation * tied) * size;
  looks_ = bound < infinity;
  const double motion = std::max(free, length - free) - bound;
  if (!(bound <= prover_->enough(motion, program.exponent))) return false;
  program.write(*problem_, near_y_, near_lambda_, *solution_);
  solution_->error_bound = relative_bound(bound, length, free);
  solution_->status = Status::solved;
  return true;
}

}  // namespace zwang
