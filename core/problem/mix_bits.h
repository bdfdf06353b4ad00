#pragma once

#include <cstdint>

namespace zwang {

// Spreads a number's bits over all 64: the last step of splitmix64 (Steele et al. 2014). A bijection.
inline std::uint64_t mix_bits(std::uint64_t h) {
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
  return h ^ (h >> 31);
}

}  // namespace zwang
