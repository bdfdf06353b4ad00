#pragma once

#include <cmath>
#include <string>

#include <zwang/bench/scenes/draw.h>
#include <zwang/bench/scenes/families.h>

// What the families that are written as matrices share: numbers of few bits, so that no entry is rounded.
namespace zwang {

inline constexpr double g_dyadic = 9.8125;  // m/s^2

// 2^-k, and 0 where k is zero_knob.
inline double small(const Knobs& knobs) {
  const double k = knobs.at("k");
  return k == zero_knob ? 0 : std::exp2(-k);
}

inline std::string numbered(const char* name, Index i) { return name + std::to_string(i); }

}  // namespace zwang
