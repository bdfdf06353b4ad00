#pragma once

#include <algorithm>
#include <charconv>
#include <concepts>
#include <cstdarg>
#include <cstdio>
#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace zwang {

// As printf writes it.
[[gnu::format(printf, 1, 2)]] inline std::string printed(const char* format, ...) {
  std::va_list values, again;
  va_start(values, format);
  va_copy(again, values);
  std::string text(static_cast<std::size_t>(std::max(0, std::vsnprintf(nullptr, 0, format, values))), ' ');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  va_end(values);
  return text;
}

// "3,402".
std::string grouped(std::integral auto count) {
  std::string digits = std::to_string(count);
  for (std::size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, 1, ',');
  return digits;
}

// "3,402 runs", "1 run".
std::string counted(std::integral auto count, const std::string& noun) {
  return grouped(count) + " " + noun + (count == 1 ? "" : "s");
}

inline std::string joined(const std::vector<std::string>& texts, const char* separator = ", ") {
  std::string all;
  for (const std::string& text : texts) all += (&text == &texts.front() ? "" : separator) + text;
  return all;
}

// The name of each, for joined() and did_you_mean(): names_of(entries, &Entry::name).
template <class Range, class Name>
std::vector<std::string> names_of(const Range& entries, Name name) {
  std::vector<std::string> names;
  for (const auto& entry : entries) names.emplace_back(std::invoke(name, entry));
  return names;
}

// "a,b" -> a | b.
inline std::vector<std::string> split(const std::string& text, char separator = ',') {
  std::vector<std::string> parts;
  std::istringstream all(text);
  for (std::string part; std::getline(all, part, separator);) parts.push_back(part);
  return parts;
}

// The number that this text is, all of it.
template <class T>
std::optional<T> number_in(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

// "; did you mean 'tower'?" for the name with the smallest edit distance, or "" when none is near.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& names);

// For a shell: 'as it is'.
inline std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace zwang
