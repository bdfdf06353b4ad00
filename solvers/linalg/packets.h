#pragma once

#include <algorithm>

#include <zwang/core/problem/types.h>

// As many doubles as the processor takes at once (they divide eight), for loops in which Eigen's own expressions would
// keep their sums in memory.
namespace zwang::packets {

using Packet = Eigen::internal::packet_traits<double>::type;
constexpr Index width = Eigen::internal::packet_traits<double>::size;

inline Index round_down(Index size) { return size / width * width; }
inline Index round_up(Index size) { return round_down(size + width - 1); }
inline Packet load(const double* x) { return Eigen::internal::ploadu<Packet>(x); }
inline void store(double* x, const Packet& a) { Eigen::internal::pstoreu(x, a); }
inline Packet all(double x) { return Eigen::internal::pset1<Packet>(x); }
// a b + c.
inline Packet multiply_add(const Packet& a, const Packet& b, const Packet& c) {
  return Eigen::internal::pmadd(a, b, c);
}
inline Packet absolute(const Packet& a) { return Eigen::internal::pabs(a); }
inline Packet smaller(const Packet& a, const Packet& b) { return Eigen::internal::pmin(a, b); }
inline Packet larger(const Packet& a, const Packet& b) { return Eigen::internal::pmax(a, b); }
inline double sum(const Packet& a) { return Eigen::internal::predux(a); }
inline double smallest(const Packet& a) { return Eigen::internal::predux_min(a); }
inline double largest(const Packet& a) { return Eigen::internal::predux_max(a); }

// part<count>(k) for eight packets at a time from `begin` to `end` (multiples of a width), and for what is left of
// them.
template <class Part>
void in_parts(Index begin, Index end, Part&& part) {
  for (; begin < end; begin += 8 * width) {
    switch (std::min<Index>(8, (end - begin) / width)) {
      case 1:
        part.template operator()<1>(begin);
        break;
      case 2:
        part.template operator()<2>(begin);
        break;
      case 3:
        part.template operator()<3>(begin);
        break;
      case 4:
        part.template operator()<4>(begin);
        break;
      case 5:
        part.template operator()<5>(begin);
        break;
      case 6:
        part.template operator()<6>(begin);
        break;
      case 7:
        part.template operator()<7>(begin);
        break;
      default:
        part.template operator()<8>(begin);
    }
  }
}

}  // namespace zwang::packets
