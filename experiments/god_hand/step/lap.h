#pragma once

#include <algorithm>

#include <zwang/core/problem/deadline.h>

namespace zwang::god {

// Adds the thread CPU time of its life [s] to a sum. To read that clock is a system call, and read at both ends of all
// laps of a frame it took much of the frame: it is read every 100 us, and wall time counts between.
class Lap {
 public:
  explicit Lap(double& sum) : sum_(sum), start_(now()) {}
  ~Lap() { sum_ += std::max(0.0, now() - start_); }
  Lap(Lap&&) = delete;

 private:
  static double now() { return thread_cpu_seconds(1e-4); }

  double& sum_;
  double start_;
};

}  // namespace zwang::god
