#pragma once

#include <zwang/core/problem/cpu_clock.h>

namespace zwang::god {

// Adds the thread CPU time of its life [s] to a sum.
class Lap {
 public:
  explicit Lap(double& sum) : sum_(sum), start_(thread_cpu_seconds()) {}
  ~Lap() { sum_ += thread_cpu_seconds() - start_; }
  Lap(const Lap&) = delete;
  Lap& operator=(const Lap&) = delete;

 private:
  double& sum_;
  double start_;
};

}  // namespace zwang::god
