#pragma once

#include <ctime>

namespace zwang::god {

// Adds the thread CPU time of its life [s] to a sum.
class Lap {
 public:
  explicit Lap(double& sum) : sum_(sum), start_(now()) {}
  ~Lap() { sum_ += now() - start_; }
  Lap(const Lap&) = delete;
  Lap& operator=(const Lap&) = delete;

 private:
  static double now() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  double& sum_;
  double start_;
};

}  // namespace zwang::god
