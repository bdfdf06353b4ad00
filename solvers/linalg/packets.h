#pragma once

#include <zwang/core/problem/types.h>

// As many doubles as the processor takes at once (they divide eight), for loops in which Eigen's own expressions would
// keep their sums in memory.
namespace zwang::packets {

using Packet = Eigen::internal::packet_traits<double>::type;
constexpr Index width = Eigen::internal::packet_traits<double>::size;

inline Packet load(const double* x) { return Eigen::internal::ploadu<Packet>(x); }
inline void store(double* x, const Packet& a) { Eigen::internal::pstoreu(x, a); }
inline Packet all(double x) { return Eigen::internal::pset1<Packet>(x); }
inline Packet all_of(const double* x) { return Eigen::internal::pload1<Packet>(x); }  // of *x
inline Packet negative(const Packet& a) { return Eigen::internal::pnegate(a); }
// a b + c.
inline Packet multiply_add(const Packet& a, const Packet& b, const Packet& c) {
  return Eigen::internal::pmadd(a, b, c);
}
inline Packet absolute(const Packet& a) { return Eigen::internal::pabs(a); }
inline Packet smaller(const Packet& a, const Packet& b) { return Eigen::internal::pmin(a, b); }
inline Packet larger(const Packet& a, const Packet& b) { return Eigen::internal::pmax(a, b); }
inline double smallest(const Packet& a) { return Eigen::internal::predux_min(a); }
inline double largest(const Packet& a) { return Eigen::internal::predux_max(a); }

}  // namespace zwang::packets
