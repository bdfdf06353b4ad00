#include <zwang/solvers/active_set/dense_dual_active_set.h>

#include <algorithm>
#include <cmath>

#include <zwang/solvers/linalg/lanes.h>

namespace zwang {
namespace {

using lanes::at;
using lanes::round_up;
using lanes::width;
using packets::all;
using packets::load;
using packets::Packet;
using packets::store;

// The first j < padded with x_j = value, where there is one.
Index find(const double* x, Index padded, double value) {
  Packet place = all(infinity), own;
  for (Index l = 0; l < packets::width; ++l) own[l] = static_cast<double>(l);
  for (Index j = 0; j < padded; j += packets::width, own += all(packets::width))
    place = packets::smaller(place, load(x + j) == all(value) ? own : all(infinity));
  return static_cast<Index>(packets::smallest(place));
}

}  // namespace

void DenseDualActiveSet::reset(Index freedom, Index room) {
  freedom_ = freedom;
  rows_ = padded_rows_ = scanned_ = loaded_ = 0;
  padded_ = std::max(width, round_up(freedom));
  const Index padded_room = std::max(width, round_up(room)), most = std::min(padded_, padded_room);
  if (v_.size() != padded_)
    for (Vector* part : {&v_, &u_, &rest_, &sigma_}) part->setZero(padded_);
  if (A_.rows() != padded_ || A_.cols() < padded_room) A_.resize(padded_, padded_room);
  if (b_.size() < padded_room)
    for (Vector* part : {&b_, &magnitude_, &slack_, &out_, &key_}) part->resize(padded_room);
  if (freedom == 0) A_.setZero();  // a caller that writes nothing
  by_rows_.reset(freedom, room);
  factor_.reset(padded_, most);
  state_.clear();
  state_.reserve(at(room));
  for (std::vector<Index>* list : {&active_, &retired_}) {
    list->clear();
    list->reserve(at(list == &active_ ? most : room));
  }
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
  state_[at(j)] = state;
  out_[j] = state == State::resting ? 0 : infinity;
}

// Rows admitted since the last time enter by_rows_, with rows that always hold up to whole lanes.
void DenseDualActiveSet::bring_in() {
  if (loaded_ == rows_) return;
  by_rows_.take(A_, loaded_, rows_);
  padded_rows_ = round_up(rows_);
  for (Index j = rows_; j < padded_rows_; ++j) {
    b_[j] = -1;
    magnitude_[j] = 1;
    out_[j] = 0;
  }
  loaded_ = rows_;
}

void DenseDualActiveSet::scan() {
  bring_in();
  scanned_ = rows_;
  for (Index j = 0; j < padded_rows_; j += width) at(slack_.data(), j) = -at(b_.data(), j);
  by_rows_.accumulate(1, v_.data(), slack_.data());
}

Index DenseDualActiveSet::choose() {
  const double length = std::sqrt(fixed_length * fixed_length + lanes::dot(v_.data(), v_.data(), padded_));
  double* const key = key_.data();
  Packet least = all(0);
  for (Index j = 0; j < padded_rows_; j += packets::width) {
    const Packet slack = load(slack_.data() + j), terms = load(magnitude_.data() + j);
    const Packet own =
        -slack > all(violation_tolerance) * (terms + all(length)) ? slack + load(out_.data() + j) : all(0);
    store(key + j, own);
    least = packets::smaller(least, own);
  }
  const double worst = packets::smallest(least);
  return worst < 0 ? find(key, padded_rows_, worst) : -1;
}

// Ties go to the steepest.
Blocking<double> DenseDualActiveSet::blocking() {
  const Index used = round_up(size());
  if (used == 0) return {};
  const double *const r = this->r(), *const u = u_.data();
  double* const time = rest_.data();
  Packet longest = all(1);
  for (Index k = 0; k < used; k += packets::width) longest = packets::larger(longest, packets::absolute(load(r + k)));
  const Packet noise = all(rank_tolerance * packets::largest(longest));
  Packet least = all(infinity);
  for (Index k = 0; k < used; k += packets::width) {
    const Packet own = load(r + k), t = own > noise ? load(u + k) / (own > noise ? own : all(1)) : all(infinity);
    store(time + k, t);
    least = packets::smaller(least, t);
  }
  const double step = packets::smallest(least);
  if (!(step < infinity)) return {.row = -1, .step = infinity};
  Packet steepest = all(0);
  for (Index k = 0; k < used; k += packets::width) {
    const Packet own = load(time + k) == all(step) ? load(r + k) : all(0);
    store(time + k, own);
    steepest = packets::larger(steepest, own);
  }
  return {.row = find(time, used, packets::largest(steepest)), .step = step};
}

void DenseDualActiveSet::enter(Index p, double multiplier, double length) {
  u_[size()] = multiplier;
  factor_.append();
  active_.push_back(p);
  set(p, State::active);
  smallest_accepted = std::min(smallest_accepted, length);
}

void DenseDualActiveSet::drop(Index j) {
  set(active_[at(j)], State::resting);
  const Index last = size() - 1;
  factor_.drop(j);
  std::copy(active_.begin() + j + 1, active_.end(), active_.begin() + j);
  std::copy(u_.data() + j + 1, u_.data() + last + 1, u_.data() + j);
  u_[last] = 0;
  active_.pop_back();
}

// (v, u) afresh from the factor.
void DenseDualActiveSet::refresh() {
  for (Index j = 0; j < size(); ++j) sigma_[j] = b_[active_[at(j)]];
  rest_.setZero();
  solve(rest_, sigma_, v_, u_);
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
  bring_in();
  for (const Index j : rows) {
    if (size() == freedom_) break;
    const double length = split(j);
    if (!(length > tolerances::warm_share)) continue;
    enter(j, 0, length);
  }
  refresh();
  restore_dual_feasibility();
}

bool DenseDualActiveSet::obey(Index j) {
  if (is_dependent(share(j))) {
    const Blocking<double> block = blocking();
    if (block.row < 0) return false;
    drop(block.row);
  }
  start_from({&j, 1});
  return is_active(j);
}

bool DenseDualActiveSet::accept(const Vector& v, const Vector& u) {
  if (has_climbed()) v_ = v;
  u_.head(size()) = u.head(size());
  const bool clean = restore_dual_feasibility();
  if (!has_climbed()) return clean;
  scan();
  return clean && choose() < 0;
}

bool DenseDualActiveSet::is_dependent(double length) {
  const bool dependent = !(length > rank_tolerance) || size() == freedom_;
  if (dependent) largest_rejected = std::max(largest_rejected, length);
  return dependent;
}

bool DenseDualActiveSet::is_satisfied(Index p, double violation) const {
  double terms = magnitude_[p];
  for (Index j = 0; j < size(); ++j) terms += std::abs(r()[j]) * magnitude_[active_[at(j)]];
  return violation <= violation_tolerance * terms;
}

void DenseDualActiveSet::retire(Index p) {
  set(p, State::retired);
  retired_.push_back(p);
}

void DenseDualActiveSet::move(double step, bool dependent) {
  lanes::add(-step, r(), u_.data(), round_up(size()));
  if (dependent) return;
  const double* const remainder = factor_.remainder();
  lanes::add(step, remainder, v_.data(), padded_);
  by_rows_.accumulate(step, remainder, slack_.data());
}

void DenseDualActiveSet::append(Index p, double multiplier, double length) {
  enter(p, multiplier, length);
  for (const Index j : retired_) set(j, State::resting);
  retired_.clear();
}

Status DenseDualActiveSet::climb(int& iterations, int most_iterations, const Deadline& deadline) {
  scan();
  return dual_climb(*this, iterations, most_iterations, deadline, [] {});
}

}  // namespace zwang
