#include <zwang/solvers/solver_entry.h>

#include <charconv>
#include <stdexcept>

#include <zwang/core/problem/did_you_mean.h>

namespace zwang {
namespace {

template <class T>
T number(const std::string& text, const char* expected) {
  T value;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) throw std::invalid_argument(expected);
  return value;
}

}  // namespace

template <>
double setting_value<double>(const std::string& text) {
  return number<double>(text, "a number");
}
template <>
int setting_value<int>(const std::string& text) {
  return number<int>(text, "an integer");
}
template <>
bool setting_value<bool>(const std::string& text) {
  if (text == "on" || text == "true" || text == "1") return true;
  if (text == "off" || text == "false" || text == "0") return false;
  throw std::invalid_argument("on or off");
}

void read_settings(std::string_view solver, std::string_view text, std::span<const SettingInfo> known,
                   const std::function<bool(std::string_view key, const std::string& value)>& set) {
  const std::string whose = "solver '" + std::string(solver) + "'";
  std::stringstream parts{std::string(text)};
  for (std::string part; std::getline(parts, part, ',');) {
    const auto equal = part.find('=');
    const std::string key = part.substr(0, equal), value = equal == std::string::npos ? "on" : part.substr(equal + 1);
    try {
      if (set(key, value)) continue;
    } catch (const std::invalid_argument& expected) {
      throw std::invalid_argument(whose + ": setting " + key + "=" + value + " should be " + expected.what());
    }
    std::vector<std::string> names;
    for (const SettingInfo& s : known) names.push_back(s.name);
    throw std::invalid_argument(whose + " has no setting '" + key + "'" + did_you_mean(key, names));
  }
}

}  // namespace zwang
