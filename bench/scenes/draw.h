#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include <zwang/core/problem/types.h>

namespace zwang {

// Seeded draws, the same on every machine (the distributions of <random> are not).
class Draw {
 public:
  explicit Draw(double seed) : engine_(static_cast<std::uint64_t>(seed)) {}
  // Uniform in [low, high), a multiple of (high - low) / 2^bits.
  double uniform(double low, double high, int bits = 32) {
    return low + (high - low) * std::ldexp(static_cast<double>(engine_() >> (64 - bits)), -bits);
  }
  int below(int count) { return static_cast<int>(uniform(0, count)); }
  Vec3 cube(double half) {
    const double x = uniform(-half, half), y = uniform(-half, half);
    return {x, y, uniform(-half, half)};
  }
  Vec3 direction() {
    for (;;)
      if (const Vec3 v = cube(1); v.squaredNorm() <= 1 && v.squaredNorm() > 0.01) return v.normalized();
  }

  // Numbers of few bits.
  int integer(int low, int high) {
    return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }
  Vector integers(Index n, int bound) {
    Vector v(n);
    for (double& x : v) x = integer(-bound, bound);
    return v;
  }
  Vector eighths(Index n, int bound) { return integers(n, bound) / 8; }
  Index index(Index n) { return static_cast<Index>(engine_() % static_cast<std::uint64_t>(n)); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace zwang
