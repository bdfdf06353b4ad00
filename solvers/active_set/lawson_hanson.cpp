#include <zwang/solvers/active_set/lawson_hanson.h>

#include <limits>

namespace zwang {
namespace {
enum State : char { zero, passive, barred };
}

bool LawsonHanson::enter(const Columns& E, Index column) {
  const double share = qr_.append(E.col(column), threshold);
  if (!(share > threshold)) return false;
  const Index last = qr_.size() - 1;
  rotated_[last] = qr_.Q().col(last).dot(r_);
  r_.noalias() -= rotated_[last] * qr_.Q().col(last);
  passive_.push_back(column);
  state_[at(column)] = State::passive;
  return true;
}

void LawsonHanson::leave(std::size_t place) {
  const Index column = passive_[place];
  qr_.drop(static_cast<Index>(place), rotated_.data());
  passive_.erase(passive_.begin() + static_cast<std::ptrdiff_t>(place));
  state_[at(column)] = State::zero;
  x_[column] = 0;
  r_.noalias() += rotated_[qr_.size()] * qr_.dropped();
}

// From the feasible x to the least-squares solution on the passive set, dropping what would turn negative on the way.
void LawsonHanson::settle(std::span<const char> free) {
  const auto bounded = [&](Index column) { return !free[at(column)]; };
  for (;;) {
    auto trial = trial_.head(qr_.size());
    trial = rotated_.head(qr_.size());
    qr_.solve(trial);
    double step = 1;
    std::size_t blocking = passive_.size();
    for (std::size_t i = 0; i < passive_.size(); ++i) {
      const double x = x_[passive_[i]], next = trial[static_cast<Index>(i)];
      if (!bounded(passive_[i]) || next > 0) continue;
      const double reach = x > 0 ? x / (x - next) : 0;
      if (blocking == passive_.size() || reach < step) {
        step = reach;
        blocking = i;
      }
    }
    if (blocking == passive_.size()) step = 1;
    for (std::size_t i = 0; i < passive_.size(); ++i) {
      double& x = x_[passive_[i]];
      x += step * (trial[static_cast<Index>(i)] - x);
    }
    if (blocking == passive_.size()) return;
    x_[passive_[blocking]] = 0;
    for (std::size_t i = passive_.size(); i-- > 0;)
      if (bounded(passive_[i]) && x_[passive_[i]] <= 0) leave(i);
  }
}

Status LawsonHanson::solve(const Columns& E, const Vector& f, std::span<const char> free, std::span<const Index> warm,
                           int& iterations, const Limits& limits) {
  const Index k = E.cols();
  qr_.reset(E.rows(), k);
  if (x_.size() < k)
    for (Vector* room : {&x_, &w_, &length_, &rotated_, &trial_}) room->resize(k);
  x_.head(k).setZero();
  r_ = f;
  passive_.clear();
  dependent_.clear();
  passive_.reserve(at(k));
  dependent_.reserve(at(k));
  state_.assign(at(k), State::zero);
  for (Index j = 0; j < k; ++j) length_[j] = E.col(j).norm();

  for (Index j = 0; j < k; ++j) {
    if (!free[at(j)]) continue;
    limits.deadline.keep();
    if (enter(E, j)) continue;
    dependent_.push_back(j);
    state_[at(j)] = State::barred;
  }
  for (const Index j : warm) {
    limits.deadline.keep();
    if (state_[at(j)] == State::zero) enter(E, j);
  }
  settle(free);

  // A gradient below `noise` is what rounding leaves of zero.
  const double noise = tolerances::violation * std::numeric_limits<double>::epsilon() * f.norm();
  for (;;) {
    if (limits.deadline.passed()) return Status::time_limit;
    w_.head(k).noalias() = E.transpose() * r_;
    Index best = -1;
    double steepest = noise;
    for (Index j = 0; j < k; ++j)
      if (state_[at(j)] == State::zero && w_[j] > steepest * length_[j]) {
        steepest = w_[j] / length_[j];
        best = j;
      }
    if (best < 0) return Status::solved;
    if (iterations >= limits.iterations) return Status::iteration_limit;
    ++iterations;
    if (!enter(E, best)) {
      state_[at(best)] = State::barred;
      continue;
    }
    settle(free);
    if (state_[at(best)] == State::passive) {
      for (char& s : state_)
        if (s == State::barred) s = State::zero;
      for (const Index j : dependent_) state_[at(j)] = State::barred;
    } else {
      state_[at(best)] = State::barred;
    }
    if (limits.each) limits.each();
  }
}

}  // namespace zwang
