#include "solvers/least_distance.h"

#include <algorithm>
#include <cmath>

namespace zwang {
namespace {

constexpr Index lanes = LeastDistance::lanes;
using Lanes = Vec<double, lanes>;

Index round_up(Index size) { return (size + lanes - 1) / lanes * lanes; }

auto at(const double* x, Index k) { return Eigen::Map<const Lanes>(x + k); }
auto at(double* x, Index k) { return Eigen::Map<Lanes>(x + k); }

double dot(const double* x, const double* y, Index padded) {
  using Wide = Vec<double, 4 * lanes>;  // a hand's 26 unknowns
  if (padded == Wide::SizeAtCompileTime) return Eigen::Map<const Wide>(x).dot(Eigen::Map<const Wide>(y));
  Lanes sum = at(x, 0).cwiseProduct(at(y, 0));
  for (Index k = lanes; k < padded; k += lanes) sum += at(x, k).cwiseProduct(at(y, k));
  return sum.sum();
}

// y = A'x over `count` columns; x stays in registers.
void multiply_transposed(const LeastDistance::Columns& A, Index count, const double* x, double* y, Index padded) {
  using Wide = Vec<double, 4 * lanes>;
  if (padded == Wide::SizeAtCompileTime) {
    const Wide own = Eigen::Map<const Wide>(x);
    for (Index j = 0; j < count; ++j) y[j] = own.dot(Eigen::Map<const Wide>(A.col(j).data()));
  } else {
    for (Index j = 0; j < count; ++j) y[j] = dot(A.col(j).data(), x, padded);
  }
}

// y += scale x.
void add(double scale, const double* x, double* y, Index padded) {
  for (Index k = 0; k < padded; k += lanes) at(y, k) += scale * at(x, k);
}

// y += A x over `count` columns, four lane vectors at a time: their sums stay in registers and do not wait for each
// other, where a column after the other would go through memory each time.
template <int width>
void accumulate(const LeastDistance::Columns& A, Index count, const double* x, double* y, Index k) {
  Eigen::Map<Vec<double, width * lanes>> target(y + k);
  Vec<double, width * lanes> sum = target;
  const double* column = A.data() + k;
  for (Index j = 0; j < count; ++j, column += A.rows())
    sum += x[j] * Eigen::Map<const Vec<double, width * lanes>>(column);
  target = sum;
}
void accumulate(const LeastDistance::Columns& A, Index count, const double* x, double* y, Index padded) {
  Index k = 0;
  for (; k + 4 * lanes <= padded; k += 4 * lanes) accumulate<4>(A, count, x, y, k);
  for (; k < padded; k += lanes) accumulate<1>(A, count, x, y, k);
}

}  // namespace

void LeastDistance::reset(Index freedom, Index rows) {
  freedom_ = freedom;
  rows_ = rows;
  padded_ = std::max(lanes, round_up(freedom));
  padded_rows_ = std::max(lanes, round_up(rows));
  if (A_.rows() != padded_ || A_.cols() < padded_rows_) A_.resize(padded_, padded_rows_);
  const Index most = std::min(padded_, padded_rows_);  // active rows
  if (Q_.rows() != padded_ || Q_.cols() < most) {
    Q_.resize(padded_, most);
    T_.resize(most, most);
    for (Vector* part : {&v_, &u_, &r_, &d_, &remainder_, &rest_}) part->resize(padded_);
  }
  if (At_.rows() < padded_rows_ || At_.cols() < padded_) {
    At_.resize(padded_rows_, padded_);
    AQ_.resize(padded_rows_, most);
    for (Vector* part : {&b, &magnitude, &slack_, &along_}) part->resize(padded_rows_);
  }
  if (freedom == 0) A_.setZero();  // a caller that fills nothing
  state_.assign(static_cast<std::size_t>(padded_rows_), State::resting);
  active_.clear();
  v_.setZero();
  u_.setZero();
  complete_ = false;
  carried_ = true;
  smallest_accepted = 1;
  largest_rejected = 0;
}

void LeastDistance::complete() {
  for (Index k = 0; k < freedom_; ++k)
    for (Index j = 0; j < rows_; ++j) At_(j, k) = A_(k, j);
  for (Index j = rows_; j < At_.rows(); ++j) {
    b[j] = -1;
    magnitude[j] = 1;
    At_.row(j).head(freedom_).setZero();
  }
  complete_ = true;
  scan();
}

void LeastDistance::scan() {
  for (Index j = 0; j < padded_rows_; j += lanes) at(slack_.data(), j) = -at(b.data(), j);
  accumulate(At_, freedom_, v_.data(), slack_.data(), padded_rows_);
}

// A remainder, over all rows.
void LeastDistance::move_along() {
  for (Index j = 0; j < padded_rows_; j += lanes) at(along_.data(), j).setZero();
  accumulate(At_, freedom_, remainder_.data(), along_.data(), padded_rows_);
}

Index LeastDistance::most_violated() const {
  const double length = std::sqrt(fixed_length * fixed_length + dot(v_.data(), v_.data(), padded_));
  Index worst = -1;
  double least = 0;
  for (Index j = 0; j < rows_; ++j)
    if (slack_[j] < least && state_[static_cast<std::size_t>(j)] == State::resting &&
        -slack_[j] > violation_tolerance * (magnitude[j] + length)) {
      worst = j;
      least = slack_[j];
    }
  return worst;
}

// Row p = Q d + remainder; r = T d. Returns the remainder's length. A Q is carried along for all rows, as the products
// that move the slacks, so d is read, not computed.
double LeastDistance::split(Index p) {
  const Index q = size();
  const double* a = A_.col(p).data();
  double* rest = remainder_.data();
  for (Index k = 0; k < padded_; k += lanes) at(rest, k) = at(a, k);
  if (carried_)
    for (Index j = 0; j < q; ++j) d_[j] = AQ_(p, j);
  else
    multiply_transposed(Q_, q, a, d_.data(), padded_);
  for (Index j = 0; j < q; ++j) rest_[j] = -d_[j];
  accumulate(Q_, q, rest_.data(), rest, padded_);
  length_ = std::sqrt(dot(rest, rest, padded_));
  // Kahan's criterion: one pass leaves eps / shortening of Q in the rest.
  if (length_ * length_ < 0.5 * dot(a, a, padded_)) {
    multiply_transposed(Q_, q, rest, rest_.data(), padded_);
    for (Index j = 0; j < q; ++j) {
      d_[j] += rest_[j];
      rest_[j] = -rest_[j];
    }
    accumulate(Q_, q, rest_.data(), rest, padded_);
    length_ = std::sqrt(dot(rest, rest, padded_));
  }
  const Index used = round_up(q);
  for (Index k = 0; k < used; k += lanes) at(r_.data(), k).setZero();
  accumulate(T_, q, d_.data(), r_.data(), used);
  return length_;
}

void LeastDistance::append(Index p, double multiplier) {
  const Index q = size();
  const double reciprocal = 1 / length_;
  for (Index k = 0; k < padded_; k += lanes) at(Q_.col(q).data(), k) = reciprocal * at(remainder_.data(), k);
  for (Index j = 0; carried_ && j < padded_rows_; j += lanes)
    at(AQ_.col(q).data(), j) = reciprocal * at(along_.data(), j);
  T_.col(q).setZero();
  for (Index k = 0; k < q; ++k) T_(k, q) = -r_[k] * reciprocal;
  T_(q, q) = reciprocal;
  u_[q] = multiplier;
  active_.push_back(p);
  state_[static_cast<std::size_t>(p)] = State::active;
  smallest_accepted = std::min(smallest_accepted, length_);
}

// Rotations of neighbouring columns gather row j of T in its last column, which leaves with it.
void LeastDistance::drop(Index j) {
  state_[static_cast<std::size_t>(active_[static_cast<std::size_t>(j)])] = State::resting;
  active_.erase(active_.begin() + j);
  const Index q = size();
  for (Index k = j; k < q; ++k) {
    const double x = T_(j, k), y = T_(j, k + 1), norm = std::sqrt(x * x + y * y);
    const double c = y / norm, s = x / norm;
    const auto rotate = [&](double* left, double* right, Index padded) {
      for (Index i = 0; i < padded; i += lanes) {
        const Lanes l = at(left, i), r = at(right, i);
        at(left, i) = c * l - s * r;
        at(right, i) = s * l + c * r;
      }
    };
    rotate(T_.col(k).data(), T_.col(k + 1).data(), round_up(k + 2));
    rotate(Q_.col(k).data(), Q_.col(k + 1).data(), padded_);
    if (carried_) rotate(AQ_.col(k).data(), AQ_.col(k + 1).data(), padded_rows_);
  }
  for (Index k = j; k < q; ++k) {
    for (Index i = j; i <= k; ++i) T_(i, k) = T_(i + 1, k);
    T_(k + 1, k) = 0;
    u_[k] = u_[k + 1];
  }
  T_.col(q).setZero();
}

// (v, u) afresh from the factors.
void LeastDistance::refresh() {
  for (Index j = 0; j < size(); ++j) rest_[j] = b[active_[static_cast<std::size_t>(j)]];
  solve_transposed(rest_);
  combine(rest_, v_);
  u_ = rest_;
  solve(u_);
}

bool LeastDistance::restore_dual_feasibility() {
  bool clean = true;
  while (size() > 0) {
    Index j = 0;
    const auto u = u_.head(size());
    if (!(u.minCoeff(&j) < -violation_tolerance * (u.cwiseAbs().maxCoeff() + v_.norm()))) break;
    drop(j);
    refresh();
    clean = false;
  }
  for (Index j = 0; j < size(); ++j) u_[j] = std::max(0.0, u_[j]);
  return clean;
}

void LeastDistance::start_from(std::span<const Index> rows) {
  constexpr double clear = 1e-7;
  carried_ = false;
  for (const Index j : rows)
    if (size() < freedom_ && split(j) > clear) append(j, 0);
  refresh();
  restore_dual_feasibility();
  if (complete_) scan();
}

// A Q of what a warm start took in: not before a step needs it.
void LeastDistance::carry() {
  if (carried_) return;
  carried_ = true;
  for (Index j = 0; j < size(); ++j) {
    AQ_.col(j).head(padded_rows_).setZero();
    accumulate(At_, freedom_, Q_.col(j).data(), AQ_.col(j).data(), padded_rows_);
  }
}

bool LeastDistance::accept(const Vector& v, const Vector& u) {
  v_ = v;
  u_.head(size()) = u.head(size());
  const bool clean = restore_dual_feasibility();
  if (!complete_) return clean;
  scan();
  return clean && most_violated() < 0;
}

LeastDistance::End LeastDistance::climb(int& iterations, int most_iterations, const Deadline& deadline) {
  for (Index p = most_violated(); p >= 0; p = most_violated()) {
    carry();
    double multiplier = 0;
    for (bool entered = false; !entered;) {
      if (iterations >= most_iterations) return End::iteration_limit;
      if (deadline.passed()) return End::time_limit;
      ++iterations;
      const Index q = size();
      const double length = split(p);
      const double violation = std::max(0.0, -slack_[p]);

      // The active row whose multiplier reaches zero first; ties go to the steepest.
      double largest = 1;
      for (Index j = 0; j < q; ++j) largest = std::max(largest, std::abs(r_[j]));
      Index block = -1;
      double step = 0;
      for (Index j = 0; j < q; ++j) {
        if (!(r_[j] > rank_tolerance * largest)) continue;
        const double t = u_[j] / r_[j];
        if (block >= 0 && !(t < step || (t == step && r_[j] > r_[block]))) continue;
        step = t;
        block = j;
      }

      // A combination of the active rows: contradicted by them, or satisfied to rounding, or one of them must leave.
      const bool dependent = !(length > rank_tolerance);
      if (dependent) {
        largest_rejected = std::max(largest_rejected, length);
        double size_of_terms = magnitude[p];
        for (Index j = 0; j < q; ++j)
          size_of_terms += std::abs(r_[j]) * magnitude[active_[static_cast<std::size_t>(j)]];
        const bool holds = violation <= violation_tolerance * size_of_terms;
        if (!holds && block < 0) return End::contradiction;
        if (holds) {
          state_[static_cast<std::size_t>(p)] = State::retired;
          break;
        }
      }

      const double full = dependent ? 0 : violation / (length * length);
      const bool blocked = block >= 0 && (dependent || step < full);
      if (!blocked) step = full;
      add(-step, r_.data(), u_.data(), round_up(q));
      multiplier += step;
      if (!dependent) {
        add(step, remainder_.data(), v_.data(), padded_);
        move_along();
        add(step, along_.data(), slack_.data(), padded_rows_);
      }
      if (blocked) {
        drop(block);
        continue;
      }
      append(p, multiplier);
      for (State& state : state_)
        if (state == State::retired) state = State::resting;
      entered = true;
    }
  }
  return End::optimal;
}

void LeastDistance::solve_transposed(Vector& x) const {
  for (Index j = size(); j-- > 0;) {
    double sum = 0;
    for (Index k = 0; k <= j; ++k) sum += T_(k, j) * x[k];
    x[j] = sum;
  }
}

void LeastDistance::solve(Vector& x) const {
  for (Index i = 0; i < size(); ++i) {
    const double own = x[i];
    for (Index k = 0; k < i; ++k) x[k] += T_(k, i) * own;
    x[i] = T_(i, i) * own;
  }
}

void LeastDistance::project(const Vector& w, Vector& x) const {
  multiply_transposed(Q_, size(), w.data(), x.data(), padded_);
}

void LeastDistance::combine(const Vector& x, Vector& w) const {
  w.setZero();
  accumulate(Q_, size(), x.data(), w.data(), padded_);
}

}  // namespace zwang
