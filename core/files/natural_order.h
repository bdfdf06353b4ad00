#pragma once

#include <algorithm>
#include <string>

namespace zwang {

// Text order with numbers by their size: "seq2" before "seq10".
inline bool natural_less(const std::string& a, const std::string& b) {
  const auto digits = [](const std::string& s, std::size_t from) {
    return std::min(s.find_first_not_of("0123456789", from), s.size()) - from;
  };
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const std::size_t p = digits(a, i), q = digits(b, j);
    if (p > 0 && q > 0) {
      if (p != q) return p < q;
      if (const int order = a.compare(i, p, b, j, q); order != 0) return order < 0;
      i += p;
      j += q;
    } else if (a[i] != b[j]) {
      return a[i] < b[j];
    } else {
      ++i;
      ++j;
    }
  }
  return a.size() < b.size();
}

}  // namespace zwang
