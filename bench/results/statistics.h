#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace zwang {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// Linear between order statistics, of the values that are not NaN; NaN when there are none. Infinite values count.
inline double quantile(std::vector<double> values, double share) {
  std::erase_if(values, [](double v) { return std::isnan(v); });
  if (values.empty()) return unknown;
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::nth_element(values.begin(), below, values.end());
  const double part = place - std::floor(place);
  const double above = part > 0 ? *std::min_element(below + 1, values.end()) : *below;
  return above == *below ? above : *below + part * (above - *below);
}

inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

struct Quartiles {
  double q1 = unknown, median = unknown, q3 = unknown;
};
inline Quartiles quartiles(const std::vector<double>& values) {
  return {quantile(values, 0.25), quantile(values, 0.5), quantile(values, 0.75)};
}

}  // namespace zwang
