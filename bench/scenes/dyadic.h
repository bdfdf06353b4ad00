#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>

#include <zwang/bench/scenes/families.h>

// What the families that are written as matrices share: numbers of few bits, so that no entry is rounded.
namespace zwang {

inline constexpr double g_dyadic = 9.8125;  // m/s^2

// 2^-k, and 0 where k is zero_knob.
inline double small(const Knobs& knobs) {
  const double k = knobs.at("k");
  return k == zero_knob ? 0 : std::exp2(-k);
}

// Draws that are the same with every standard library.
class SmallNumbers {
 public:
  explicit SmallNumbers(double seed) : random_(static_cast<std::uint64_t>(seed)) {}
  int integer(int low, int high) {
    return low + static_cast<int>(random_() % static_cast<std::uint64_t>(high - low + 1));
  }
  Vector integers(Index n, int bound) {
    Vector v(n);
    for (double& x : v) x = integer(-bound, bound);
    return v;
  }
  Vector eighths(Index n, int bound) { return integers(n, bound) / 8; }
  Index index(Index n) { return static_cast<Index>(random_() % static_cast<std::uint64_t>(n)); }

 private:
  std::mt19937_64 random_;
};

inline std::string numbered(const char* name, Index i) { return name + std::to_string(i); }

}  // namespace zwang
