#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <zwang/solvers/form/body_rows.h>
#include <zwang/solvers/linalg/lanes.h>

// Blocks of six by six, of one body or joint or of eight at once.
namespace zwang::joint_blocks {

// What is written for one joint holds for eight.
using lanes::Pack;

inline double root(double x) { return std::sqrt(x); }
using lanes::root;
inline double with_sign_against(double top, double norm) { return top > 0 ? -norm : norm; }
inline Pack with_sign_against(const Pack& top, const Pack& norm) {
  return Pack::each([](auto x, auto length) { return x > packets::all(0) ? -length : length; }, top, norm);
}
inline double least(double x) { return x; }
inline double least(const Pack& x) { return lanes::at(x.data(), 0).minCoeff(); }
inline double total(double x) { return x; }
inline double total(const Pack& x) { return lanes::at(x.data(), 0).sum(); }
inline double smaller(double a, double b) { return std::min(a, b); }
inline Pack smaller(const Pack& a, const Pack& b) {
  return Pack::each([](auto x, auto y) { return packets::smaller(x, y); }, a, b);
}
inline void set(double& x, double value) { x = value; }
inline void set(Pack& x, double value) { x = Pack(value); }

template <class Scalar>
using Column = std::array<Scalar, 6>;
template <class Scalar>
using Square = std::array<Column<Scalar>, 6>;

inline const BodyRows::Lanes nothing = BodyRows::Lanes::Zero();

// Entries of a joint's row, by joint.
using Parts = std::array<const double*, 8>;
inline void gather(const Parts& parts, Column<double>& row) { std::copy_n(parts[0], 6, row.begin()); }
inline void gather(const Parts& parts, Column<Pack>& row) {
  std::array<Pack, 8> entries;
  for (std::size_t l = 0; l < 8; ++l) entries[l] = Pack::load(parts[l]);
  lanes::transpose(entries);
  std::copy_n(entries.begin(), 6, row.begin());
}

// The other way, of the first `count` joints.
using Targets = std::array<double*, 8>;
inline void scatter(const Column<double>& row, std::size_t, const Targets& targets) {
  std::copy_n(row.begin(), 6, targets[0]);
  std::fill_n(targets[0] + 6, 2, 0.0);
}
inline void scatter(const Column<Pack>& row, std::size_t count, const Targets& targets) {
  std::array<Pack, 8> entries;
  std::copy_n(row.begin(), 6, entries.begin());
  entries[6] = entries[7] = Pack(0);
  lanes::transpose(entries);
  for (std::size_t l = 0; l < count; ++l) entries[l].store(targets[l]);
}

template <class Scalar>
Column<Scalar> zero() {
  Column<Scalar> x;
  for (Scalar& entry : x) set(entry, 0);
  return x;
}

// x -= a y.
template <class Scalar>
void subtract(const Scalar& a, const Column<Scalar>& y, Column<Scalar>& x) {
  for (std::size_t i = 0; i < 6; ++i) x[i] = multiply_add(Scalar(-a), y[i], x[i]);
}

template <class Scalar>
void scale(const Scalar& a, Column<Scalar>& x) {
  for (Scalar& entry : x) entry *= a;
}

// I + scale v v', which takes a column to beta e_k and leaves what stands above. A column that meets one reflection
// after the other stays in registers meanwhile: storing it costs more than the products.
template <class Scalar>
struct Reflection {
  Column<Scalar> v;
  Scalar scale, beta, reciprocal;  // of beta

  void take(const Column<Scalar>& column, std::size_t k) {
    v = column;
    for (std::size_t i = 0; i < k; ++i) set(v[i], 0);
    Scalar even = v[0] * v[0], odd = v[1] * v[1];
    for (std::size_t i = 2; i < 6; i += 2) {
      even = multiply_add(v[i], v[i], even);
      odd = multiply_add(v[i + 1], v[i + 1], odd);
    }
    beta = with_sign_against(v[k], root(even + odd));
    v[k] -= beta;
    scale = 1 / (beta * v[k]);
    reciprocal = scale * v[k];
  }
  void apply(Column<Scalar>& x) const {
    Scalar even = v[0] * x[0], odd = v[1] * x[1];
    for (std::size_t i = 2; i < 6; i += 2) {
      even = multiply_add(v[i], x[i], even);
      odd = multiply_add(v[i + 1], x[i + 1], odd);
    }
    const Scalar sum = scale * (even + odd);
    for (std::size_t i = 0; i < 6; ++i) x[i] = multiply_add(v[i], sum, x[i]);
  }
};

}  // namespace zwang::joint_blocks
