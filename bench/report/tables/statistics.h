#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include <zwang/bench/results/statistics.h>

namespace zwang::report {

using zwang::median;

// exp(mean log(v + shift)) - shift; NaN when empty. The shift keeps the tiniest times from ruling the mean.
inline double geometric_mean(const std::vector<double>& values, double shift = 0) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0;
  for (const double v : values) sum += std::log(v + shift);
  return std::exp(sum / static_cast<double>(values.size())) - shift;
}

// y = a x^p by least squares in logarithms; `error` is the standard error of p (NaN with fewer than three points).
struct PowerLaw {
  double factor, exponent, error;
};

inline PowerLaw fit_power_law(const std::vector<double>& x, const std::vector<double>& y) {
  const double n = static_cast<double>(x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0, rest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sx += std::log(x[i]) / n, sy += std::log(y[i]) / n;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = std::log(x[i]) - sx;
    sxx += dx * dx;
    sxy += dx * (std::log(y[i]) - sy);
  }
  const double p = sxy / sxx;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double r = std::log(y[i]) - sy - p * (std::log(x[i]) - sx);
    rest += r * r;
  }
  return {std::exp(sy - p * sx), p, n > 2 ? std::sqrt(rest / (n - 2) / sxx) : std::numeric_limits<double>::quiet_NaN()};
}

}  // namespace zwang::report
