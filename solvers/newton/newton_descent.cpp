#include <algorithm>
#include <cmath>
#include <limits>

#include <zwang/solvers/newton/newton.h>

namespace zwang {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double largest_penalty = 1e10;
constexpr int most_steps = 300;

}  // namespace

// slack_, term_ and the weights of the rows in the max, at d.
void Newton::weigh(double s) {
  for (Index i = 0; i < rows_.rows(); ++i) {
    slack_[i] = h_[i] - row_dot(i, d_);
    term_[i] = l_[i] + s * slack_[i];
    weight_[i] = is_equality(i) || term_[i] > 0 ? s : 0;
  }
}

// All rows near z_u held as if they were equality rows: in a wall almost all of them push in the end, and from d = 0
// the method takes ten steps and more to find that out. Kept when holding them pulls at few; else d = 0, l = 0.
bool Newton::start(const Problem& p, const Deadline& deadline) {
  constexpr double strong = 1e6;
  for (Index i = 0; i < rows_.rows(); ++i) weight_[i] = is_equality(i) || h_[i] > -1 ? strong : 0;
  if (!factorize(p, deadline)) return false;
  double last = infinity, length = infinity;
  for (int pass = 0; pass < 3; ++pass) {
    last = length;
    multiply_mass(p, d_, product_);
    step_ = -product_;
    for (Index i = 0; i < rows_.rows(); ++i) {
      if (weight_[i] == 0) continue;
      slack_[i] = h_[i] - row_dot(i, d_);
      add_row(i, l_[i] + strong * slack_[i], step_);
    }
    factor_.solve(step_);
    d_ += step_;
    length = mass_norm(p, step_);
    for (Index i = 0; i < rows_.rows(); ++i)
      if (weight_[i] != 0) l_[i] += strong * (slack_[i] - row_dot(i, step_));
  }
  force_.setZero();
  double pull = 0, push = 0;
  for (Index i = 0; i < rows_.rows(); ++i) {
    push += std::max(l_[i], 0.0);
    if (is_equality(i) || l_[i] >= 0) continue;
    pull -= l_[i];
    l_[i] = 0;
  }
  if (!(pull <= 0.25 * push)) {
    d_.setZero();
    l_.setZero();
    return false;
  }
  s_ = strong;
  rate_ = last > 0 ? length / last : 0;
  return true;
}

// The step of each part to where its derivative along step_ vanishes: a piecewise linear, increasing function, so
// Newton's method within a bracket ends after a few of its pieces. True when all parts take the whole step.
bool Newton::line_search(double s) {
  for (Search& part : search_) part = {.high = infinity};
  for (Index j = 0; j < step_.size(); ++j) {
    Search& part = search_[at(factor_.part_of_position(static_cast<int>(j)))];
    part.linear += product_[j] * d_[j];  // product_ = M step
    part.quadratic += product_[j] * step_[j];
    part.zero += force_[j] * step_[j];  // -derivative at 0
  }
  int open = static_cast<int>(search_.size());
  for (int round = 0; round < 60 && open > 0; ++round) {
    for (Search& part : search_) {
      part.derivative = part.linear + part.step * part.quadratic;
      part.slope = part.quadratic;
    }
    for (Index i = 0; i < rows_.rows(); ++i) {
      Search& part = search_[at(factor_.part_of_row(static_cast<int>(i)))];
      if (part.done) continue;
      const double term = term_[i] - s * part.step * change_[i];
      if (!is_equality(i) && !(term > 0)) continue;
      part.derivative -= term * change_[i];
      part.slope += s * change_[i] * change_[i];
    }
    for (Search& part : search_) {
      if (part.done) continue;
      part.done = std::abs(part.derivative) <= 1e-9 * std::abs(part.zero) || !(part.slope > 0);
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
  bool whole = true;
  for (const Search& part : search_) whole = whole && part.step == 1;
  return whole;
}

// Until a step of l moves d by less than `close`, relative.
Newton::End Newton::descend(const Problem& p, double close, const SolveOptions& options, const Deadline& deadline,
                            Solution& s) {
  double last_move = infinity;
  for (;;) {
    start_ = d_;
    double length = infinity;
    bool settled = false;
    while (!settled) {
      weigh(s_);
      multiply_mass(p, d_, product_);
      force_ = -product_;
      for (Index i = 0; i < rows_.rows(); ++i)
        if (weight_[i] != 0) add_row(i, term_[i], force_);
      const bool may_go_on = s.iterations < most_steps && s.iterations < options.max_iterations;
      const bool factorized = may_go_on && factorize(p, deadline);
      if (deadline.passed() || s.iterations >= options.max_iterations) {
        s.status = deadline.passed() ? Status::time_limit : Status::iteration_limit;
        return End::limit;
      }
      if (!factorized) return End::stuck;
      ++s.iterations;
      step_ = force_;
      factor_.solve(step_);
      for (Index i = 0; i < rows_.rows(); ++i) change_[i] = row_dot(i, step_);
      multiply_mass(p, step_, product_);
      length = std::sqrt(std::max(0.0, product_.dot(step_)));
      const bool whole = line_search(s_);
      for (Index j = 0; j < step_.size(); ++j)
        step_[j] *= search_[at(factor_.part_of_position(static_cast<int>(j)))].step;
      d_ += step_;
      scale_ = std::max(rows_.free_length, mass_norm(p, d_));
      if (!std::isfinite(length)) return End::stuck;
      bool same = whole;
      for (Index i = 0; i < rows_.rows() && same; ++i)
        same = is_equality(i) || (weight_[i] != 0) == (term_[i] - s_ * change_[i] > 0);
      settled = same || length <= 1e-5 * std::min(last_move, scale_) || length <= 1e-13 * scale_;
      if (options.observe) {
        far_d_ = d_.cast<Real>();
        far_l_ = term_.cast<Real>();
        for (Index i = 0; i < rows_.rows(); ++i)
          if (weight_[i] == 0) far_l_[i] = 0;
        write(p, s);
        options.observe(s.iterations, s.z, s.lambda);
      }
    }
    double gain = 0;  // h'u of the step u of l
    for (Index i = 0; i < rows_.rows(); ++i) {
      const double before = l_[i], term = before + s_ * (h_[i] - row_dot(i, d_));
      l_[i] = is_equality(i) ? term : std::max(0.0, term);
      if (is_equality(i) || l_[i] > before) gain += (l_[i] - before) * h_[i];
    }
    step_ = d_ - start_;
    const double move = mass_norm(p, step_);
    if (last_move < infinity) rate_ = last_move > 0 ? move / last_move : 0;
    if (move <= close * scale_)
      return gain >= 1e8 * reach_ * move && certify(p, deadline, s) ? End::infeasible : End::settled;
    if (move > 0.1 * last_move) s_ = std::min(10 * s_, largest_penalty);
    last_move = move;
  }
}

}  // namespace zwang
