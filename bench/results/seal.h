#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace zwang {

// A line of a results file checks itself: its last key, "check", is the CRC-32 (as in zlib) of all bytes before it.

constexpr std::uint32_t crc32_of(std::string_view bytes) {
  constexpr auto table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t c = i;
      for (int k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320u ^ (c >> 1) : c >> 1;
      t[i] = c;
    }
    return t;
  }();
  std::uint32_t c = 0xffffffffu;
  for (const char b : bytes) c = table[(c ^ static_cast<unsigned char>(b)) & 0xff] ^ (c >> 8);
  return c ^ 0xffffffffu;
}

inline constexpr std::string_view seal_start = ",\"check\":\"";
inline constexpr std::size_t seal_size = seal_start.size() + 10;  // 8 hexadecimal digits, "}

// The JSON object with its check as last key.
inline std::string sealed(std::string object) {
  if (!object.empty() && object.back() == '}') object.pop_back();
  char digits[9];
  std::snprintf(digits, sizeof digits, "%08x", static_cast<unsigned>(crc32_of(object)));
  return object.append(seal_start).append(digits).append("\"}");
}

inline bool has_seal(std::string_view line) {
  return line.size() > seal_size && line.substr(line.size() - seal_size).starts_with(seal_start);
}

// The line ends with the check of what stands before it.
inline bool is_intact(std::string_view line) {
  return has_seal(line) && sealed(std::string(line.substr(0, line.size() - seal_size)) + "}") == line;
}

}  // namespace zwang
