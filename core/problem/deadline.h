#pragma once

#include <chrono>
#include <cmath>
#include <limits>

#include <zwang/core/problem/solver.h>

namespace zwang {

// Seconds of wall clock left before a solve must end.
class Deadline {
 public:
  explicit Deadline(double seconds = std::numeric_limits<double>::infinity()) : seconds_(seconds) {}
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  double left() const { return seconds_ - elapsed(); }
  bool passed() const { return std::isfinite(seconds_) && left() <= 0; }
  // For long preparations, which have no iterate to show yet.
  void keep() const {
    if (passed()) throw Stopped{Status::time_limit, "the time limit was met before there was an iterate"};
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  double seconds_;
};

}  // namespace zwang
