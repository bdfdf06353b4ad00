#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include <zwang/solvers/form/body_rows.h>
#include <zwang/solvers/linalg/lanes.h>

// Blocks of six by six, of one body or joint or of as many at once as the processor's vectors hold: of two vectors, a
// column and a reflection that meets it would not fit into its registers.
namespace zwang::joint_blocks {

// What is written for one joint holds for a group.
using Group = lanes::PackOf<1>;
using lanes::unroll;

inline double root(double x) { return std::sqrt(x); }
using lanes::root;
inline double with_sign_against(double top, double norm) { return top > 0 ? -norm : norm; }
inline Group with_sign_against(const Group& top, const Group& norm) {
  return Group::each([](auto x, auto length) { return x > packets::all(0) ? -length : length; }, top, norm);
}
inline double least(double x) { return x; }
inline double least(const Group& x) { return packets::smallest(x.part[0]); }
inline double total(double x) { return x; }
inline double total(const Group& x) { return Eigen::internal::predux(x.part[0]); }
inline double smaller(double a, double b) { return std::min(a, b); }
inline Group smaller(const Group& a, const Group& b) {
  return Group::each([](auto x, auto y) { return packets::smaller(x, y); }, a, b);
}
inline void set(double& x, double value) { x = value; }
inline void set(Group& x, double value) { x = Group(value); }

template <class Scalar>
using Column = std::array<Scalar, 6>;
template <class Scalar>
using Square = std::array<Column<Scalar>, 6>;

inline const BodyRows::Lanes nothing = BodyRows::Lanes::Zero();

template <class Scalar>
constexpr std::size_t width = 1;
template <>
constexpr std::size_t width<Group> = Group::lanes;

// Six entries of each joint, which stand in eight lanes.
template <class Scalar>
using Parts = std::array<const double*, width<Scalar>>;
template <class Scalar>
using Targets = std::array<double*, width<Scalar>>;
inline void gather(const Parts<double>& parts, Column<double>& row) { std::copy_n(parts[0], 6, row.begin()); }
inline void scatter(const Column<double>& row, const Targets<double>& targets) {
  std::copy_n(row.begin(), 6, targets[0]);
  std::fill_n(targets[0] + 6, 2, 0.0);
}
[[gnu::always_inline]] inline void gather(const Parts<Group>& parts, Column<Group>& row) {
  constexpr std::size_t side = width<Group>;
  unroll<BodyRows::lanes / side>([&](auto square) {
    std::array<Group, side> entries;
    unroll<side>([&](auto l) { entries[l] = Group::load(parts[l] + square * side); });
    lanes::transpose(entries);
    unroll<side>([&](auto k) {
      if constexpr (square * side + k < 6) row[square * side + k] = entries[k];
    });
  });
}
[[gnu::always_inline]] inline void scatter(const Column<Group>& row, const Targets<Group>& targets) {
  constexpr std::size_t side = width<Group>;
  unroll<BodyRows::lanes / side>([&](auto square) {
    std::array<Group, side> entries;
    unroll<side>([&](auto k) {
      if constexpr (square * side + k < 6)
        entries[k] = row[square * side + k];
      else
        entries[k] = Group(0);
    });
    lanes::transpose(entries);
    unroll<side>([&](auto l) { entries[l].store(targets[l] + square * side); });
  });
}

template <class Scalar>
[[gnu::always_inline]] inline Column<Scalar> zero() {
  Column<Scalar> x;
  unroll<6>([&](auto i) { set(x[i], 0); });
  return x;
}
template <class Scalar>
[[gnu::always_inline]] inline Column<Scalar> unit(std::size_t k) {
  Column<Scalar> x;
  unroll<6>([&](auto i) { set(x[i], i == k); });
  return x;
}

// x -= a y.
template <class Scalar>
[[gnu::always_inline]] inline void subtract(const Scalar& a, const Column<Scalar>& y, Column<Scalar>& x) {
  const Scalar minus = -a;
  unroll<6>([&](auto i) { x[i] = multiply_add(minus, y[i], x[i]); });
}

template <class Scalar>
[[gnu::always_inline]] inline void scale(const Scalar& a, Column<Scalar>& x) {
  unroll<6>([&](auto i) { x[i] *= a; });
}

// I + scale v v', which takes a column to beta e_k and leaves what stands above. A column that meets one reflection
// after the other stays in registers meanwhile: storing it costs more than the products.
template <class Scalar>
struct Reflection {
  Column<Scalar> v;
  Scalar scale, beta, reciprocal;  // of beta

  [[gnu::always_inline]] void take(const Column<Scalar>& column, std::size_t k) {
    v = column;
    for (std::size_t i = 0; i < k; ++i) set(v[i], 0);
    Scalar even = v[0] * v[0], odd = v[1] * v[1];
    unroll<2>([&](auto i) {
      even = multiply_add(v[2 * i + 2], v[2 * i + 2], even);
      odd = multiply_add(v[2 * i + 3], v[2 * i + 3], odd);
    });
    beta = with_sign_against(v[k], root(even + odd));
    v[k] -= beta;
    scale = 1 / (beta * v[k]);
    reciprocal = scale * v[k];
  }
  [[gnu::always_inline]] void apply(Column<Scalar>& x) const {
    Scalar even = v[0] * x[0], odd = v[1] * x[1];
    unroll<2>([&](auto i) {
      even = multiply_add(v[2 * i + 2], x[2 * i + 2], even);
      odd = multiply_add(v[2 * i + 3], x[2 * i + 3], odd);
    });
    const Scalar sum = scale * (even + odd);
    unroll<6>([&](auto i) { x[i] = multiply_add(v[i], sum, x[i]); });
  }
};

}  // namespace zwang::joint_blocks
