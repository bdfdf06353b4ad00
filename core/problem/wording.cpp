#include <zwang/core/problem/wording.h>

#include <numeric>
#include <utility>

namespace zwang {
namespace {

// Levenshtein's distance, two neighbours in the wrong order counted once; three rows at a time.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> last, before(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    last = std::exchange(before, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({before[j] + 1, row[j - 1] + 1, before[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

std::string did_you_mean(const std::string& name, const std::vector<std::string>& names) {
  const auto nearer = [&](const std::string& a, const std::string& b) {
    return edit_distance(name, a) < edit_distance(name, b);
  };
  const auto best = std::min_element(names.begin(), names.end(), nearer);
  // Two slips; in a short word one, or anything would be near it.
  if (best == names.end() || edit_distance(name, *best) > std::clamp<std::size_t>(name.size() / 3, 1, 2)) return {};
  return "; did you mean '" + *best + "'?";
}

}  // namespace zwang
