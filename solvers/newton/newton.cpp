#include <zwang/solvers/newton/newton.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <zwang/solvers/linalg/tolerances.h>
#include <zwang/solvers/solver_entry.h>

namespace zwang {
namespace {

constexpr Index largest_dense = 2000000;  // unknowns x rows for which the dense method is still a way out
constexpr int least_patience = 300;  // steps, or as many as there are rows: a heap of 3,000 may need a thousand
constexpr long double real_eps = std::numeric_limits<long double>::epsilon();

}  // namespace

bool Newton::factorize(const Problem& p, const Deadline& deadline) {
  return factor_.factorize(p.M, rows_.g, {weight_.data(), at(weight_.size())}, deadline);
}

void Newton::multiply_mass(const Problem& p, const Vector& x, Vector& y) const {
  y.setZero();
  for (const MassEntry& e : mass_) y[e.row] += p.M.valuePtr()[e.from] * x[e.column];
}

double Newton::mass_norm(const Problem& p, const Vector& x) {
  multiply_mass(p, x, work_);
  return std::sqrt(std::max(0.0, work_.dot(x)));
}

void Newton::prepare(const Problem& p, const SolveOptions& options, const Deadline& deadline) {
  factor_.analyze(p.M, rows_.g, options, deadline);
  const Index n = factor_.size(), k = rows_.rows();
  place_.resize(rows_.g.column.size());
  for (std::size_t e = 0; e < place_.size(); ++e) place_[e] = factor_.position(rows_.g.column[e]);
  mass_.clear();
  for (Index j = 0; j < p.size(); ++j) {
    const int begin = p.M.outerIndexPtr()[j];
    const int end = p.M.isCompressed() ? p.M.outerIndexPtr()[j + 1] : begin + p.M.innerNonZeroPtr()[j];
    for (int e = begin; e < end; ++e)
      if (const int row = factor_.position(p.M.innerIndexPtr()[e]), column = factor_.position(static_cast<int>(j));
          row >= 0 && column >= 0)
        mass_.push_back({row, column, e});
  }
  for (Vector* v : {&d_, &step_, &force_, &product_, &work_}) v->setZero(n);
  for (Vector* v : {&slack_, &term_, &change_, &weight_}) v->setZero(k);
  h_ = rows_.exact_h.cwiseMax(Real(-tolerances::horizon)).cast<double>();
  search_.resize(at(factor_.parts()));
  far_d_.setZero(n);
  far_force_.setZero(n);
  far_l_.setZero(k);
  violation_.setZero(k);
  warm_rows_.multipliers(p, rows_, options.warm_start, l_);
}

// z_u breaks no row, so it is the answer to the last bit. Multipliers of an earlier frame would only be worked off down
// to the smallest numbers there are, which is far from z = 0.
bool Newton::rests() const {
  for (Index i = 0; i < rows_.rows(); ++i)
    if (is_equality(i) ? rows_.exact_h[i] != 0 : rows_.exact_h[i] > 0) return false;
  return true;
}

void Newton::write(const Problem& p, Solution& s) const {
  s.z = p.z_u;
  for (int j = 0; j < factor_.size(); ++j) {
    const Index column = factor_.column(j);
    s.z[column] = static_cast<double>(Real(p.z_u[column]) + std::ldexp(far_d_[j], rows_.exponent));
  }
  s.lambda.setZero(p.rows());
  for (Index i = 0; i < rows_.rows(); ++i)
    s.lambda[rows_.row[at(i)]] = rows_.multiplier(i, is_equality(i) ? far_l_[i] : std::max(far_l_[i], Real(0)));
}

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
  constexpr double strong = tolerances::newton_hold;
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
  if (!(pull <= tolerances::newton_few_pull * push)) {
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
  bool whole = true;
  for (const Search& part : search_) whole = whole && part.step == 1;
  return whole;
}

// Until a step of l moves d by less than `close`, relative.
Newton::End Newton::descend(const Problem& p, double close, const SolveOptions& options, const Deadline& deadline,
                            Solution& s) {
  const int most_steps = std::max(least_patience, static_cast<int>(rows_.rows()));
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
      scale_ = std::max(rows_.free_norm, mass_norm(p, d_));
      if (!std::isfinite(length)) return End::stuck;
      bool same = whole;
      for (Index i = 0; i < rows_.rows() && same; ++i)
        same = is_equality(i) || (weight_[i] != 0) == (term_[i] - s_ * change_[i] > 0);
      settled = same || length <= tolerances::newton_inner * std::min(last_move, scale_) ||
                length <= tolerances::newton_nothing * scale_;
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
      return gain >= tolerances::out_of_reach * reach_ * move && certify(p, deadline, s) ? End::infeasible
                                                                                         : End::settled;
    if (move > tolerances::newton_slow * last_move) s_ = std::min(10 * s_, tolerances::newton_largest_penalty);
    last_move = move;
  }
}

// far_force_ = J'l - M d and violation_ = h - G d of the problem's stored doubles.
void Newton::extended_force(const Problem& p) {
  far_force_.setZero();
  for (const MassEntry& e : mass_) far_force_[e.row] -= Real(p.M.valuePtr()[e.from]) * far_d_[e.column];
  for (Index i = 0; i < rows_.rows(); ++i) {
    const Real norm = rows_.row_norm[i], l = far_l_[i] / norm;
    Real sum = 0;
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, rows_.row[at(i)]); it; ++it) {
      if (it.value() == 0) continue;
      const int j = factor_.position(static_cast<int>(it.col()));
      sum += Real(it.value()) * far_d_[j];
      far_force_[j] += Real(it.value()) * l;
    }
    violation_[i] = rows_.exact_h[i] - sum / norm;
  }
}

bool Newton::polish_answer(const Problem& p, const SolveOptions& options, const Deadline& deadline, Solution& s) {
  far_d_ = d_.cast<Real>();
  far_l_ = l_.cast<Real>();
  for (Index i = 0; i < rows_.rows(); ++i) weight_[i] = is_equality(i) || l_[i] > 0 ? s_ : 0;
  double last = std::numeric_limits<double>::infinity(), length = last, worst = 0;
  bool changed = true;
  for (int pass = 0; pass < 40; ++pass) {
    if (deadline.passed()) return false;
    extended_force(p);
    // Rows leave and enter.
    bool now_changed = false;
    for (Index i = 0; i < rows_.rows(); ++i) {
      if (is_equality(i)) continue;
      const double size = rows_.magnitude[i] + scale_;
      if (weight_[i] != 0 && far_l_[i] + Real(s_) * violation_[i] < -Real(tolerances::pull) * scale_) {
        weight_[i] = 0;
        now_changed = true;
      } else if (weight_[i] == 0 && violation_[i] > tolerances::wide_violation * real_eps * size) {
        weight_[i] = s_;
        now_changed = true;
      }
      if (weight_[i] == 0 && far_l_[i] != 0) {
        for (int e = rows_.g.begin[at(i)]; e < rows_.g.begin[at(i) + 1]; ++e)
          far_force_[place_[at(e)]] -= far_l_[i] * Real(rows_.g.value[at(e)]);
        far_l_[i] = 0;
      }
    }
    worst = 0;
    for (Index i = 0; i < rows_.rows(); ++i)
      if (weight_[i] != 0)
        worst = std::max(worst, static_cast<double>(std::abs(violation_[i])) / (rows_.magnitude[i] + scale_));
    if (!now_changed && !changed && length <= tolerances::newton_polished * scale_ &&
        worst <= tolerances::violation * static_cast<double>(real_eps)) {
      write(p, s);
      s.redundant.assign(rows_.idle.begin(), rows_.idle.end());
      const double mu = (1 / std::clamp(rate_, tolerances::newton_least_rate, 1.0) - 1) / s_;
      const double error = length + worst * scale_ / std::sqrt(std::max(mu, tolerances::newton_least_eigenvalue));
      s.status = error <= accepted_error(options.tolerance) * scale_ ? Status::solved : Status::solved_ill_conditioned;
      return true;
    }
    changed = now_changed;
    if (changed || pass == 0) {
      if (!factorize(p, deadline)) return false;
      if (changed) ++s.iterations;
    }
    step_ = far_force_.cast<double>();
    for (Index i = 0; i < rows_.rows(); ++i)
      if (weight_[i] != 0) add_row(i, s_ * static_cast<double>(violation_[i]), step_);
    factor_.solve(step_);
    far_d_ += step_.cast<Real>();
    for (Index i = 0; i < rows_.rows(); ++i)
      if (weight_[i] != 0) far_l_[i] += Real(s_) * (violation_[i] - Real(row_dot(i, step_)));
    last = length;
    length = mass_norm(p, step_);
    if (!std::isfinite(length)) return false;
    if (!changed && last < std::numeric_limits<double>::infinity() && last > tolerances::newton_telling * scale_)
      rate_ = length / last;
  }
  return false;
}

// What d and l are worth as they stand: the polish tells how far they are off, and its answer is thrown away. One step
// of it would not do: where rows are nearly dependent, the rate of convergence hides the slowest direction.
bool Newton::judge(const Problem& p, const SolveOptions& options, const Deadline& deadline, Solution& s) {
  const int steps = s.iterations;
  const bool settles = polish_answer(p, options, deadline, s);
  s.iterations = steps;
  if (!settles) return false;
  step_ = (far_d_ - d_.cast<Real>()).cast<double>();
  if (!(mass_norm(p, step_) <= accepted_error(options.tolerance) * scale_)) return false;
  far_d_ = d_.cast<Real>();
  far_l_ = l_.cast<Real>();
  write(p, s);
  return true;
}

// polish=off. True where the solution is complete.
bool Newton::solve_alone(const Problem& p, const SolveOptions& options, const Deadline& deadline, Solution& s) {
  for (double close = options.tolerance; close > tolerances::newton_nothing; close /= 10) {
    const End end = descend(p, close, options, deadline, s);
    if (end == End::infeasible) return true;
    if (end != End::settled || deadline.passed()) break;
    if (judge(p, options, deadline, s)) return true;
  }
  return false;
}

// Where the rows contradict each other, l grows by s times the violations that no d can mend, and these are a Farkas
// vector: u >= 0 on inequality rows, G'u = 0, h'u > 0. What is left of G'u is taken out by the same contraction as in
// the polish; extended_polish.h then judges the vector as the referee will see it.
bool Newton::certify(const Problem& p, const Deadline& deadline, Solution& s) {
  far_d_.setZero();
  for (Index i = 0; i < rows_.rows(); ++i)
    far_l_[i] = is_equality(i) ? h_[i] - row_dot(i, d_) : weight_[i] != 0 ? std::max(0.0, h_[i] - row_dot(i, d_)) : 0;
  const Real least = Real(tolerances::newton_part) * far_l_.lpNorm<Eigen::Infinity>();
  for (Index i = 0; i < rows_.rows(); ++i) {
    if (std::abs(far_l_[i]) <= least) far_l_[i] = 0;
    weight_[i] = far_l_[i] != 0 ? s_ : 0;
  }
  if (!factorize(p, deadline)) return false;
  for (int pass = 0; pass < 12; ++pass) {
    extended_force(p);
    step_ = far_force_.cast<double>();
    factor_.solve(step_);
    for (Index i = 0; i < rows_.rows(); ++i)
      if (weight_[i] != 0) far_l_[i] -= Real(s_) * row_dot(i, step_);
  }
  change_ = far_l_.cast<double>();
  return proof_.certify(p, rows_, change_, s);
}

void Newton::solve(const Problem& p, const SolveOptions& options, Solution& s) {
  const Deadline deadline(options.time_limit);
  if (!begin(rows_, p, options, deadline, s)) return;
  prepare(p, options, deadline);
  if (rests()) {
    write(p, s);
    s.redundant.assign(rows_.idle.begin(), rows_.idle.end());
    s.status = Status::solved;
    return;
  }
  s_ = penalty;
  rate_ = 1;
  reach_ = std::max(rows_.free_norm, 1.0);
  if (!options.warm_start && hold_all) start(p, deadline);
  if (!polish) {
    if (solve_alone(p, options, deadline, s)) return;
  } else {
    for (const double close : tolerances::newton_close) {
      const End end = descend(p, close, options, deadline, s);
      if (end == End::infeasible) return;
      if (end == End::limit || end == End::stuck) break;
      if (polish_answer(p, options, deadline, s)) return;
    }
    const bool at_limit = s.status == Status::iteration_limit || s.status == Status::time_limit;
    if (!at_limit && !deadline.passed() && p.size() * rows_.rows() <= largest_dense) {
      SolveOptions rest = options;
      rest.time_limit = deadline.left();
      exact_.solve(p, rest, s);
      s.handed_to = DualActiveSet::name;
      s.fallback = true;
      return;
    }
  }
  far_d_ = d_.cast<Real>();
  far_l_ = l_.cast<Real>();
  write(p, s);
  if (s.status == Status::iteration_limit || s.status == Status::time_limit) return;
  if (deadline.passed()) {
    s.status = Status::time_limit;
    return;
  }
  s.status = Status::numerical_failure;
  s.message = polish ? "the rows are too close to dependent for this method, and too many for a dense one"
                     : "the rows are too close to dependent for this method alone, or contradict each other";
}

template SolverEntry entry<Newton>(SolverEntry);

}  // namespace zwang
