#pragma once

#include <array>
#include <cmath>
#include <limits>

#include <zwang/core/problem/deadline.h>

namespace zwang {

// How far a linearly converging iteration still is from its limit, from the lengths of its steps: a step d that shrinks
// by rho per iteration leaves d rho / (1 - rho). A short step alone says little where rho is 0.999.
class LinearConvergenceEstimate {
 public:
  void record(double step) { steps_[count_++ % window] = step; }
  // Steps no longer than `rounding` have arrived: they shrink no more.
  double distance_to_go(double rounding) const {
    const double last = steps_[(count_ + window - 1) % window];
    if (last <= rounding) return 0;
    if (count_ < window) return std::numeric_limits<double>::infinity();
    const double rho = std::pow(last / steps_[count_ % window], 1.0 / (window - 1));
    return rho < 1 ? last * rho / (1 - rho) : std::numeric_limits<double>::infinity();
  }

 private:
  static constexpr std::size_t window = 8;
  std::array<double, window> steps_ = {};
  std::size_t count_ = 0;
};

}  // namespace zwang
