#pragma once

#include <type_traits>
#include <vector>

#include <zwang/core/model/pose.h>

namespace zwang::god {

// visit(number) for every number of numbers, choices, poses, matrices and lists of them, in the order they have. What a
// visitor writes to numbers that are not const is written to the value.
template <class T, class Visit>
void each_number(T& value, Visit&& visit) {
  if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    visit(value);
  } else if constexpr (std::is_same_v<std::remove_const_t<T>, Pose<double>>) {
    each_number(value.position, visit), each_number(value.rotation, visit);
  } else if constexpr (requires { value.reshaped(); }) {
    for (auto&& number : value.reshaped()) visit(number);
  } else {
    for (auto& part : value) each_number(part, visit);
  }
}

// What writes such numbers to `out`, and what takes them from `from` on.
inline auto write_numbers(std::vector<double>& out) {
  return [&out](const auto& number) { out.push_back(static_cast<double>(number)); };
}
inline auto take_numbers(const double*& from) {
  return [&from](auto& number) { number = static_cast<std::remove_reference_t<decltype(number)>>(*from++); };
}

}  // namespace zwang::god
