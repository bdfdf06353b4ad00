#pragma once

#include <zlib.h>
#include <string>
#include <string_view>

#include <zwang/core/problem/wording.h>

namespace zwang {

// A line of a results file checks itself: its last key, "check", is the CRC-32 of all bytes before it.

inline constexpr std::string_view seal_start = ",\"check\":\"";
inline constexpr std::size_t seal_size = seal_start.size() + 10;  // 8 hexadecimal digits, "}

// The JSON object with its check as last key.
inline std::string sealed(std::string object) {
  if (!object.empty() && object.back() == '}') object.pop_back();
  const unsigned long check = crc32_z(0, reinterpret_cast<const Bytef*>(object.data()), object.size());
  return object.append(seal_start).append(printed("%08lx", check)).append("\"}");
}

// The line ends with the check of what stands before it.
inline bool is_intact(std::string_view line) {
  return line.size() > seal_size && sealed(std::string(line.substr(0, line.size() - seal_size)) + "}") == line;
}

}  // namespace zwang
