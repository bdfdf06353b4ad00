#pragma once

#include <cstdint>
#include <string_view>

namespace zwang {

// Spreads a number's bits over all 64: the last step of splitmix64 (Steele et al. 2014). A bijection.
inline std::uint64_t mix_bits(std::uint64_t h) {
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
  return h ^ (h >> 31);
}

// FNV-1a, 64 bits (Fowler, Noll & Vo). `hash`: of the text before, to go on from there.
inline std::uint64_t fnv1a(std::string_view text, std::uint64_t hash = 14695981039346656037u) {
  for (const char byte : text) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211u;
  return hash;
}

}  // namespace zwang
