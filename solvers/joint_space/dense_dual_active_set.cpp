#include <zwang/solvers/joint_space/dense_dual_active_set.h>

#include <algorithm>
#include <cmath>

namespace zwang {
namespace {

using lanes::at;
using lanes::round_up;
using lanes::width;
constexpr double infinity = std::numeric_limits<double>::infinity();

double least_of(const double* x, Index padded) {
  lanes::Lanes least = at(x, 0);
  for (Index k = width; k < padded; k += width) least = least.cwiseMin(at(x, k));
  return least.minCoeff();
}

}  // namespace

void DenseDualActiveSet::reset(Index freedom, Index room) {
  freedom_ = freedom;
  rows_ = padded_rows_ = scanned_ = carried_ = 0;
  padded_ = std::max(width, round_up(freedom));
  const Index padded_room = std::max(width, round_up(room)), most = std::min(padded_, padded_room);
  if (v_.size() != padded_)
    for (Vector* part : {&v_, &u_, &rest_}) part->resize(padded_);
  if (A_.rows() != padded_ || A_.cols() < padded_room) A_.resize(padded_, padded_room);
  if (At_.rows() < padded_room || At_.cols() < padded_) At_.resize(padded_room, padded_);
  if (AQ_.rows() < padded_room || AQ_.cols() < most) AQ_.resize(padded_room, most);
  if (b_.size() < padded_room)
    for (Vector* part : {&b_, &magnitude_, &slack_, &along_, &out_, &key_}) part->resize(padded_room);
  if (freedom == 0) A_.setZero();  // a caller that writes nothing
  factor_.reset(padded_, most);
  state_.clear();
  active_.clear();
  retired_.clear();
  v_.setZero();
  u_.setZero();
  smallest_accepted = 1;
  largest_rejected = 0;
}

double* DenseDualActiveSet::admit(double b, double magnitude) {
  b_[rows_] = b;
  magnitude_[rows_] = magnitude;
  out_[rows_] = 0;
  state_.push_back(State::resting);
  return A_.col(rows_++).data();
}

void DenseDualActiveSet::set(Index j, State state) {
  state_[static_cast<std::size_t>(j)] = state;
  out_[j] = state == State::resting ? 0 : infinity;
}

// Slacks of all rows; those admitted since the last time enter A by rows, with rows that always hold up to whole lanes.
void DenseDualActiveSet::scan() {
  if (scanned_ < rows_) {
    for (Index k = 0; k < freedom_; ++k)
      for (Index j = scanned_; j < rows_; ++j) At_(j, k) = A_(k, j);
    padded_rows_ = round_up(rows_);
    for (Index j = rows_; j < padded_rows_; ++j) {
      b_[j] = -1;
      magnitude_[j] = 1;
      out_[j] = 0;
      At_.row(j).head(freedom_).setZero();
    }
    scanned_ = rows_;
  }
  for (Index j = 0; j < padded_rows_; j += width) at(slack_.data(), j) = -at(b_.data(), j);
  lanes::accumulate(At_, freedom_, v_.data(), slack_.data(), 0, padded_rows_);
}

// A Q of the rows admitted since the last time, and of all after a warm start: not before a step needs it.
void DenseDualActiveSet::carry() {
  if (carried_ == rows_) return;
  const Index begin = carried_ / width * width;
  for (Index j = 0; j < size(); ++j) {
    AQ_.col(j).segment(begin, padded_rows_ - begin).setZero();
    lanes::accumulate(At_, freedom_, factor_.column(j), AQ_.col(j).data(), begin, padded_rows_);
  }
  carried_ = rows_;
}

// Tried: one pass that keeps the worst row so far. Its branches go one way or the other from hand to hand, which costs
// more than the products: 64 hands took 1 us each more than one hand solved over and over.
Index DenseDualActiveSet::most_violated() {
  const double length = std::sqrt(fixed_length * fixed_length + lanes::dot(v_.data(), v_.data(), padded_));
  const double *const slack = slack_.data(), *const size = magnitude_.data(), *const out = out_.data();
  double* const key = key_.data();
  for (Index j = 0; j < padded_rows_; ++j) {
    const double own = slack[j] + out[j];
    key[j] = -slack[j] > violation_tolerance * (size[j] + length) ? own : 0.0;
  }
  if (padded_rows_ == 0) return -1;
  const double least = least_of(key, padded_rows_);
  return least < 0 ? std::find(key, key + padded_rows_, least) - key : -1;
}

// Ties go to the steepest.
Blocking<double> DenseDualActiveSet::blocking() {
  const Index used = round_up(size());
  if (used == 0) return {};
  const double *const r = factor_.r().data(), *const u = u_.data();
  double* const time = rest_.data();
  lanes::Lanes largest = lanes::Lanes::Ones();
  for (Index k = 0; k < used; k += width) largest = largest.cwiseMax(at(r, k).cwiseAbs());
  const double noise = rank_tolerance * largest.maxCoeff();
  for (Index j = 0; j < used; ++j) {
    const double falling = r[j] > noise ? r[j] : 1.0, t = u[j] / falling;
    time[j] = r[j] > noise ? t : infinity;
  }
  Blocking<double> block{.row = -1, .step = least_of(time, used)};
  for (Index j = 0; block.step < infinity && j < size(); ++j)
    if (time[j] == block.step && (block.row < 0 || r[j] > r[block.row])) block.row = j;
  return block;
}

double DenseDualActiveSet::split(Index p) {
  const double* const a = A_.col(p).data();
  return p < carried_ ? factor_.split_known(a, AQ_.data() + p, AQ_.rows()) : factor_.split(a);
}

void DenseDualActiveSet::enter(Index p, double multiplier, double length) {
  u_[size()] = multiplier;
  factor_.append();
  active_.push_back(p);
  set(p, State::active);
  smallest_accepted = std::min(smallest_accepted, length);
}

void DenseDualActiveSet::drop(Index j) {
  set(active_[static_cast<std::size_t>(j)], State::resting);
  active_.erase(active_.begin() + j);
  factor_.drop(j);
  if (carried_ > 0) factor_.follow(AQ_, padded_rows_);
  for (Index k = j; k < size(); ++k) u_[k] = u_[k + 1];
  u_[size()] = 0;
}

// (v, u) afresh from the factor.
void DenseDualActiveSet::refresh() {
  for (Index j = 0; j < size(); ++j) u_[j] = b_[active_[static_cast<std::size_t>(j)]];
  factor_.solve_transposed(u_);
  factor_.combine(u_, v_);
  factor_.solve(u_);
}

bool DenseDualActiveSet::restore_dual_feasibility() {
  bool clean = true;
  while (size() > 0) {
    Index j = 0;
    const auto u = u_.head(size());
    if (!(u.minCoeff(&j) < -violation_tolerance * (u.cwiseAbs().maxCoeff() + v_.norm()))) break;
    drop(j);
    refresh();
    clean = false;
  }
  u_.head(size()) = u_.head(size()).cwiseMax(0);
  return clean;
}

void DenseDualActiveSet::start_from(std::span<const Index> rows) {
  for (const Index j : rows) {
    if (size() == freedom_) break;
    if (const double length = split(j); length > tolerances::warm_share) enter(j, 0, length);
  }
  refresh();
  restore_dual_feasibility();
}

bool DenseDualActiveSet::accept(const Vector& v, const Vector& u) {
  if (has_climbed()) v_ = v;
  u_.head(size()) = u.head(size());
  const bool clean = restore_dual_feasibility();
  if (!has_climbed()) return clean;
  scan();
  return clean && most_violated() < 0;
}

Index DenseDualActiveSet::choose() {
  const Index p = most_violated();
  if (p >= 0) carry();
  return p;
}

bool DenseDualActiveSet::is_dependent(double length) {
  const bool dependent = !(length > rank_tolerance) || size() == freedom_;
  if (dependent) largest_rejected = std::max(largest_rejected, length);
  return dependent;
}

bool DenseDualActiveSet::is_satisfied(Index p, double violation) const {
  double terms = magnitude_[p];
  for (Index j = 0; j < size(); ++j)
    terms += std::abs(factor_.r()[j]) * magnitude_[active_[static_cast<std::size_t>(j)]];
  return violation <= violation_tolerance * terms;
}

void DenseDualActiveSet::retire(Index p) {
  set(p, State::retired);
  retired_.push_back(p);
}

void DenseDualActiveSet::move(double step, bool dependent) {
  lanes::add(-step, factor_.r().data(), u_.data(), round_up(size()));
  if (dependent) return;
  lanes::add(step, factor_.remainder(), v_.data(), padded_);
  for (Index j = 0; j < padded_rows_; j += width) at(along_.data(), j).setZero();
  lanes::accumulate(At_, freedom_, factor_.remainder(), along_.data(), 0, padded_rows_);
  lanes::add(step, along_.data(), slack_.data(), padded_rows_);
}

void DenseDualActiveSet::append(Index p, double multiplier, double length) {
  const double reciprocal = 1 / length;
  for (Index j = 0; j < padded_rows_; j += width) at(AQ_.col(size()).data(), j) = reciprocal * at(along_.data(), j);
  enter(p, multiplier, length);
  for (const Index j : retired_) set(j, State::resting);
  retired_.clear();
}

Status DenseDualActiveSet::climb(int& iterations, int most_iterations, const Deadline& deadline) {
  scan();
  return dual_climb(*this, iterations, most_iterations, deadline, [] {});
}

}  // namespace zwang
