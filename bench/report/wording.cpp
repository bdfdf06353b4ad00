#include <zwang/bench/report/wording.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace zwang::report {

std::string shell_word(const std::string& word) {
  const auto plain = [](char ch) {
    return std::isalnum(static_cast<unsigned char>(ch)) || std::strchr("._-+:=,/@%", ch);
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  return quoted(word);
}

std::string scientific(double value, int digits) {
  if (std::isnan(value)) return "unknown";
  if (std::isinf(value) || std::abs(value) >= std::numeric_limits<double>::max())
    return value > 0 ? "infinite" : "-infinite";
  if (value == 0) return "0";
  const std::string out = printed("%.*e", digits, value);  // C pads exponents to two digits: 1e-08 reads better as 1e-8
  const std::size_t e = out.find('e');
  const std::size_t first = out.find_first_not_of("0", e + 2);
  if (first == std::string::npos) return out.substr(0, e);
  return out.substr(0, e + 1) + (out[e + 1] == '-' ? "-" : "") + out.substr(first);
}

std::string duration(double seconds) {
  if (!std::isfinite(seconds)) return "unknown";
  constexpr std::pair<double, const char*> units[] = {{1, "s"}, {1e-3, "ms"}, {1e-6, "us"}, {1e-9, "ns"}};
  for (const auto& [size, unit] : units)
    if (seconds >= 0.9995 * size || size == 1e-9) {
      const double value = seconds / size;
      return printed("%.*f %s", value < 9.95 ? 1 : 0, value, unit);
    }
  return "";
}

}  // namespace zwang::report
