#pragma once

#include <chrono>
#include <cmath>
#include <limits>

#include <zwang/core/problem/cpu_clock.h>
#include <zwang/core/problem/solver.h>

namespace zwang {

// CPU seconds of the calling thread, too large by at most `slack`. Reading that clock is a system call, longer than
// many an iteration; the wall clock is not. So it is read once in `slack`, and wall time counts since.
inline double thread_cpu_seconds(double slack) {
  static constinit thread_local double wall = -std::numeric_limits<double>::infinity(), cpu = 0;
  const double now = std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  if (!(now - wall <= slack)) {
    cpu = thread_cpu_seconds();
    wall = now;
  }
  return cpu + (now - wall);
}

// Seconds of this thread's CPU time left before a solve must end, to a hundredth of the limit: what other processes do
// besides does not count.
class Deadline {
 public:
  explicit Deadline(double seconds = std::numeric_limits<double>::infinity())
      : seconds_(seconds), start_(std::isfinite(seconds) ? now() : 0) {}
  double left() const { return std::isfinite(seconds_) ? seconds_ - (now() - start_) : seconds_; }
  bool passed() const { return left() <= 0; }
  // For long preparations, which have no iterate to show yet.
  void keep() const {
    if (passed()) throw Stopped{Status::time_limit, "the time limit was met before there was an iterate"};
  }

 private:
  double now() const { return thread_cpu_seconds(seconds_ / 100); }
  double seconds_, start_;
};

}  // namespace zwang
