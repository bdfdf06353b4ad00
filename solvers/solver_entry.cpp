#include <zwang/solvers/solver_entry.h>

#include <sstream>
#include <stdexcept>

#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

template <class T>
T number(const std::string& text, const char* expected) {
  if (const std::optional<T> value = number_in<T>(text)) return *value;
  throw std::invalid_argument(expected);
}

}  // namespace

std::string text_of(SettingValue value) {
  std::ostringstream text;
  std::visit([&](auto* v) { text << std::boolalpha << *v; }, value);
  return text.str();
}

void set_from(const std::string& text, SettingValue value) {
  if (double** v = std::get_if<double*>(&value))
    **v = number<double>(text, "a number");
  else if (int** i = std::get_if<int*>(&value))
    **i = number<int>(text, "an integer");
  else if (std::string** word = std::get_if<std::string*>(&value))
    **word = text;
  else if (text == "on" || text == "true" || text == "1")
    *std::get<bool*>(value) = true;
  else if (text == "off" || text == "false" || text == "0")
    *std::get<bool*>(value) = false;
  else
    throw std::invalid_argument("on or off");
}

std::string too_large(const Problem& problem, Index most_unknowns, Index most_rows) {
  const auto beyond = [](Index is, Index most, const char* what) {
    return is > most ? std::to_string(is) + what + "; limited to " + std::to_string(most) : "";
  };
  const std::string many = beyond(problem.size(), most_unknowns, " unknowns");
  return many.empty() ? beyond(problem.rows(), most_rows, " rows") : many;
}

void read_settings(std::string_view solver, std::string_view text, std::span<const SettingInfo> known,
                   const std::function<void(std::size_t k, const std::string& value)>& set) {
  const std::string whose = "solver '" + std::string(solver) + "'";
  for (const std::string& part : split(std::string(text))) {
    const auto equal = part.find('=');
    const std::string key = part.substr(0, equal), value = equal == std::string::npos ? "on" : part.substr(equal + 1);
    const auto found = std::ranges::find(known, key, &SettingInfo::name);
    if (found == known.end())
      throw std::invalid_argument(whose + " has no setting '" + key + "'" +
                                  did_you_mean(key, names_of(known, &SettingInfo::name)));
    try {
      set(found - known.begin(), value);
    } catch (const std::invalid_argument& expected) {
      throw std::invalid_argument(whose + ": setting " + key + "=" + value + " should be " + expected.what());
    }
  }
}

}  // namespace zwang
