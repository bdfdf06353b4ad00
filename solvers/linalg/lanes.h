#pragma once

#include <array>
#include <cmath>
#include <cstring>

#include <zwang/solvers/linalg/line_matrix.h>
#include <zwang/solvers/linalg/multiply_add.h>
#include <zwang/solvers/linalg/packets.h>

// Products of small dense matrices whose columns are padded to whole vectors of eight doubles. The sums of four such
// vectors (a hand's 26 unknowns) stay in registers, and none depends on another.
namespace zwang::lanes {

constexpr Index width = 8;
using Lanes = Vec<double, width>;
constexpr Index four = 4 * width;

inline Index round_up(Index size) { return (size + width - 1) / width * width; }
inline auto at(const double* x, Index k) { return Eigen::Map<const Lanes>(x + k); }
inline auto at(double* x, Index k) { return Eigen::Map<Lanes>(x + k); }

// each(0), each(1), ... in so many words: what a loop goes through stays in memory.
template <std::size_t count, class Each>
[[gnu::always_inline]] inline void unroll(Each&& each) {
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    (each(std::integral_constant<std::size_t, i>{}), ...);
  }(std::make_index_sequence<count>{});
}

// The same number of several bodies, joints or cones, one a lane, in as many of the processor's vectors. Eigen's array
// of eight would pass through memory between any two operations where a vector of the processor is shorter.
template <int count>
struct PackOf {
  static constexpr int parts = count;
  static constexpr Index lanes = count * packets::width;
  packets::Packet part[parts];

  PackOf() = default;
  explicit PackOf(const packets::Packet& x)
    requires(count == 1)
      : part{x} {}
  explicit PackOf(double x) {
    for (auto& own : part) own = packets::all(x);
  }
  const double* data() const { return reinterpret_cast<const double*>(part); }
  double* data() { return reinterpret_cast<double*>(part); }
  static PackOf load(const double* x) {
    PackOf out;
    for (int v = 0; v < parts; ++v) out.part[v] = packets::load(x + v * packets::width);
    return out;
  }
  void store(double* x) const {
    for (int v = 0; v < parts; ++v) packets::store(x + v * packets::width, part[v]);
  }

  template <class Operation, class... Others>
  [[gnu::always_inline]] static PackOf each(Operation&& operation, const Others&... x) {
    PackOf out;
    unroll<parts>([&](auto v) { out.part[v] = operation(x.part[v]...); });
    return out;
  }
  friend PackOf operator+(const PackOf& a, const PackOf& b) {
    return each([](auto x, auto y) { return Eigen::internal::padd(x, y); }, a, b);
  }
  friend PackOf operator-(const PackOf& a, const PackOf& b) {
    return each([](auto x, auto y) { return Eigen::internal::psub(x, y); }, a, b);
  }
  friend PackOf operator*(const PackOf& a, const PackOf& b) {
    return each([](auto x, auto y) { return Eigen::internal::pmul(x, y); }, a, b);
  }
  friend PackOf operator/(const PackOf& a, const PackOf& b) {
    return each([](auto x, auto y) { return Eigen::internal::pdiv(x, y); }, a, b);
  }
  PackOf operator-() const {
    return each([](auto x) { return Eigen::internal::pnegate(x); }, *this);
  }
  friend PackOf operator/(double a, const PackOf& b) { return PackOf(a) / b; }
  PackOf& operator+=(const PackOf& b) { return *this = *this + b; }
  PackOf& operator-=(const PackOf& b) { return *this = *this - b; }
  PackOf& operator*=(const PackOf& b) { return *this = *this * b; }
  friend PackOf multiply_add(const PackOf& a, const PackOf& b, const PackOf& c) {
    return each([](auto x, auto y, auto z) { return Eigen::internal::pmadd(x, y, z); }, a, b, c);
  }
  friend PackOf abs(const PackOf& a) {
    return each([](auto x) { return Eigen::internal::pabs(x); }, a);
  }
};
using Pack = PackOf<static_cast<int>(width / packets::width)>;

// Rows and columns change places: of a square of `side` vectors.
template <int count>
[[gnu::always_inline]] inline void transpose(std::array<PackOf<count>, PackOf<count>::lanes>& x) {
  constexpr auto side = static_cast<std::size_t>(packets::width);
  const std::array<PackOf<count>, PackOf<count>::lanes> from = x;
  for (std::size_t r = 0; r < count; ++r)
    for (std::size_t c = 0; c < count; ++c) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"
      Eigen::internal::PacketBlock<packets::Packet, packets::width> block;
#pragma GCC diagnostic pop
      for (std::size_t i = 0; i < side; ++i) block.packet[i] = from[r * side + i].part[c];
      Eigen::internal::ptranspose(block);
      for (std::size_t i = 0; i < side; ++i) x[c * side + i].part[r] = block.packet[i];
    }
}

// The processor's own roots, where they set no errno: Eigen's of eight doubles are approximations, a digit short.
template <int count>
[[gnu::always_inline]] inline PackOf<count> root(const PackOf<count>& x) {
  double entries[PackOf<count>::lanes];
  std::memcpy(entries, x.data(), sizeof entries);
  for (double& own : entries) own = std::sqrt(own);
  PackOf<count> out;
  std::memcpy(out.data(), entries, sizeof entries);
  return out;
}

// Several times three numbers that stand side by side: the first of each, the second, the third.
struct Threes {
  using One = PackOf<1>;
  std::array<One, 3> x;

  static Threes load(const double* from) {
    const packets::Packet a = packets::load(from), b = packets::load(from + side), c = packets::load(from + 2 * side);
    return {{One{apart<0>(a, b, c, each)}, One{apart<1>(a, b, c, each)}, One{apart<2>(a, b, c, each)}}};
  }
  void store(double* to) const {
    const packets::Packet a = x[0].part[0], b = x[1].part[0], c = x[2].part[0];
    packets::store(to, together<0>(a, b, c, each));
    packets::store(to + side, together<1>(a, b, c, each));
    packets::store(to + 2 * side, together<2>(a, b, c, each));
  }

 private:
  static constexpr int side = packets::width;
  static constexpr auto each = std::make_integer_sequence<int, side>{};
  // Entry 3 l + i of the three.
  template <int i, int... l>
  static packets::Packet apart(packets::Packet a, packets::Packet b, packets::Packet c,
                               std::integer_sequence<int, l...>) {
    const auto two = __builtin_shufflevector(a, b, (3 * l + i < 2 * side ? 3 * l + i : 0)...);
    return __builtin_shufflevector(two, c, (3 * l + i < 2 * side ? l : 3 * l + i - side)...);
  }
  // Its inverse: entry j = i side + l is entry j / 3 of vector j % 3.
  template <int i, int... l>
  static packets::Packet together(packets::Packet a, packets::Packet b, packets::Packet c,
                                  std::integer_sequence<int, l...>) {
    const auto two =
        __builtin_shufflevector(a, b, ((i * side + l) % 3 < 2 ? (i * side + l) % 3 * side + (i * side + l) / 3 : 0)...);
    return __builtin_shufflevector(two, c, ((i * side + l) % 3 < 2 ? l : side + (i * side + l) / 3)...);
  }
};

// part<vectors>(k) for four vectors of rows at a time from `begin` to `end`, and for the one, two or three that are
// left: one vector after the other would wait for its own sums.
template <class Part>
void in_parts(Index begin, Index end, Part&& part) {
  for (; begin + 4 * width <= end; begin += 4 * width) part.template operator()<4>(begin);
  const Index left = end - begin;
  if (left == 3 * width) part.template operator()<3>(begin);
  if (left == 2 * width) part.template operator()<2>(begin);
  if (left == width) part.template operator()<1>(begin);
}

inline double dot(const double* x, const double* y, Index padded) {
  Lanes sum = at(x, 0).cwiseProduct(at(y, 0));
  if (padded == four) {  // in two sums
    Lanes other = at(x, width).cwiseProduct(at(y, width));
    sum = multiply_add(at(x, 2 * width), at(y, 2 * width), sum);
    other = multiply_add(at(x, 3 * width), at(y, 3 * width), other);
    return (sum + other).sum();
  }
  for (Index k = width; k < padded; k += width) sum = multiply_add(at(x, k), at(y, k), sum);
  return sum.sum();
}

// y += scale x.
inline void add(double scale, const double* x, double* y, Index padded) {
  for (Index k = 0; k < padded; k += width) at(y, k) = multiply_add(scale, at(x, k), at(y, k));
}

// y = A'x over `count` columns, of what lies between the zeros of a long x: a contact meets two bodies.
inline void multiply_transposed(const Columns& A, Index count, const double* x, double* y, Index padded) {
  Index begin = 0, end = padded;
  const auto is_zero = [&](Index k) { return (at(x, k).array() == 0).all(); };
  while (padded > four && begin + width < end && is_zero(begin)) begin += width;
  while (padded > four && begin + width < end && is_zero(end - width)) end -= width;
  for (Index j = 0; j < count; ++j) y[j] = dot(A.col(j).data() + begin, x + begin, end - begin);
}

// y += A x over `count` columns, rows from `begin` to `end`; y -= A x likewise. In two sums.
template <int sign, int vectors>
void accumulate_part(const auto& A, Index count, const double* x, double* y, Index k) {
  using Part = Vec<double, vectors * width>;
  Eigen::Map<Part> target(y + k);
  Part even = target, odd = Part::Zero();
  const double* column = A.data() + k;
  Index j = 0;
  for (; j + 1 < count; j += 2, column += 2 * A.rows()) {
    even = multiply_add(sign * x[j], Eigen::Map<const Part>(column), even);
    odd = multiply_add(sign * x[j + 1], Eigen::Map<const Part>(column + A.rows()), odd);
  }
  if (j < count) even = multiply_add(sign * x[j], Eigen::Map<const Part>(column), even);
  target = even + odd;
}
void accumulate(const auto& A, Index count, const double* x, double* y, Index begin, Index end) {
  if (count == 0) return;
  in_parts(begin, end, [&]<int vectors>(Index k) { accumulate_part<1, vectors>(A, count, x, y, k); });
}
void subtract(const auto& A, Index count, const double* x, double* y, Index begin, Index end) {
  if (count == 0) return;
  in_parts(begin, end, [&]<int vectors>(Index k) { accumulate_part<-1, vectors>(A, count, x, y, k); });
}

// Rotates neighbouring columns from `first` on, one pair after the other: (l, r) becomes (c l - s r, s l + c r), and r
// is the l of the next pair, kept in registers. Rows from 0 to `rows`.
template <int vectors>
void rotate_part(Columns& A, Index first, Index pairs, const double* c, const double* s, Index k) {
  using Part = Vec<double, vectors * width>;
  double* column = A.col(first).data() + k;
  Part left = Eigen::Map<const Part>(column);
  for (Index j = 0; j < pairs; ++j, column += A.rows()) {
    const Part right = Eigen::Map<const Part>(column + A.rows());
    Eigen::Map<Part>{column} = multiply_add(c[j], left, -s[j] * right);
    left = multiply_add(s[j], left, c[j] * right);
  }
  Eigen::Map<Part>{column} = left;
}
inline void rotate(Columns& A, Index first, Index pairs, const double* c, const double* s, Index rows) {
  in_parts(0, rows, [&]<int vectors>(Index k) { rotate_part<vectors>(A, first, pairs, c, s, k); });
}

}  // namespace zwang::lanes
