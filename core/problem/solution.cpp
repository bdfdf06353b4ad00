#include <zwang/core/problem/solution.h>

#include <array>

namespace zwang {

std::string_view to_string(Status status) {
  static constexpr std::array<std::string_view, 10> words{
      "unsolved",    "solved",    "solved, ill-conditioned", "infeasible", "iteration limit", "time limit",
      "unsupported", "bad input", "numerical failure",       "crashed"};
  const auto k = static_cast<std::size_t>(status);
  return k < words.size() ? words[k] : "unknown";
}

}  // namespace zwang
