#pragma once

#include <cmath>

#include <zwang/core/problem/types.h>

namespace zwang {

// a b + c, rounded once where the processor can. Written out where speed asks for it: the build itself contracts
// nothing, so that a function inlined in two files has the same bits in both.
inline double multiply_add(double a, double b, double c) {
#ifdef __FMA__
  return std::fma(a, b, c);
#else
  return a * b + c;
#endif
}

struct MultiplyAdd {
  double operator()(double a, double b, double c) const { return multiply_add(a, b, c); }
  template <class Packet>
  Packet packetOp(const Packet& a, const Packet& b, const Packet& c) const {
    return Eigen::internal::pmadd(a, b, c);
  }
};

// The same of vectors, entry by entry; `a` may be one number for all.
template <class A, class B, class C>
auto multiply_add(const Eigen::DenseBase<A>& a, const Eigen::DenseBase<B>& b, const Eigen::DenseBase<C>& c) {
  return Eigen::CwiseTernaryOp<MultiplyAdd, const A, const B, const C>(a.derived(), b.derived(), c.derived());
}
template <class B, class C>
auto multiply_add(double a, const Eigen::DenseBase<B>& b, const Eigen::DenseBase<C>& c) {
  return multiply_add(B::PlainObject::Constant(b.rows(), b.cols(), a), b, c);
}

}  // namespace zwang

template <>
struct Eigen::internal::functor_traits<zwang::MultiplyAdd> {
  enum { Cost = 2 * NumTraits<double>::MulCost, PacketAccess = packet_traits<double>::HasMul };
};
