#pragma once

#include <cmath>
#include <string>

#include <zwang/core/problem/wording.h>

namespace zwang {

// What a number may be: from `low` to `high`, or between them where they are out themselves; in `unit`.
struct Range {
  double low = -HUGE_VAL, high = HUGE_VAL;
  const char* unit = "";
  bool open = false;

  bool holds(double value) const {
    return std::isfinite(value) && (open ? low < value && value < high : low <= value && value <= high);
  }
  // "from 1 to 100,000 Hz", "from 0 N on", "between 0 and 0.1 m", "above 0 s".
  std::string words() const {
    const auto number = [](double x) { return x < 1000 ? printed("%g", x) : grouped(std::llround(x)); };
    const bool ends = std::isfinite(high);
    std::string text = (!open ? "from " : ends ? "between " : "above ") + number(low);
    if (ends) text += (open ? " and " : " to ") + number(high);
    if (*unit != '\0') text += std::string(" ") + unit;
    return ends || open ? text : text + " on";
  }
};

inline Range from_to(double low, double high, const char* unit = "") { return {low, high, unit}; }
inline Range between(double low, double high, const char* unit = "") { return {low, high, unit, true}; }
inline Range from(double low, const char* unit = "") { return from_to(low, HUGE_VAL, unit); }
inline Range above(double low, const char* unit = "") { return between(low, HUGE_VAL, unit); }

}  // namespace zwang
