#pragma once

#include <array>
#include <concepts>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <zwang/core/problem/solver.h>

namespace zwang {

// What two processes of zwang say to each other: native-endian bytes, both being built together.

template <class T, class Named>
concept same_but_const = std::same_as<std::remove_const_t<T>, Named>;

// An iterate of a solve that is observed.
struct Iterate {
  int iteration = 0;
  Vector z = {}, lambda = {};
};

// The fields of each type that is sent, in one list for both directions. Others add an overload beside their type.
void fields(auto visit, same_but_const<Problem> auto& x) {
  visit(x.name, x.M, x.z_u, x.J, x.c, x.kind, x.key, x.mu, x.law);
}
void fields(auto visit, same_but_const<Solution> auto& x) {
  visit(x.status, x.z, x.lambda, x.iterations, x.certificate, x.redundant, x.margins, x.fallback, x.range_gap,
        x.handed_to, x.error_bound, x.message);
}
void fields(auto visit, same_but_const<WarmStart> auto& x) { visit(x.key, x.lambda); }
void fields(auto visit, same_but_const<Iterate> auto& x) { visit(x.iteration, x.z, x.lambda); }

struct Outgoing {
  std::string bytes = {};
  void move(const void* from, std::size_t size) { bytes.append(static_cast<const char*>(from), size); }
};

struct Incoming {
  std::string_view left;
  void require(std::size_t count, std::size_t size) const {
    if (count > left.size() / size) throw std::runtime_error("a message ends too early");
  }
  void move(void* to, std::size_t size) {
    require(size, 1);
    if (size > 0) std::memcpy(to, left.data(), size);
    left.remove_prefix(size);
  }
};

// Sends a value, or receives it: numbers as they are, lists behind their length, else field by field.
template <class Wire, class T>
void walk(Wire& wire, T& value) {
  constexpr bool receives = std::is_same_v<Wire, Incoming>;
  if constexpr (std::is_trivially_copyable_v<std::remove_const_t<T>>) {
    wire.move(&value, sizeof value);
  } else if constexpr (requires { value.outerIndexPtr(); }) {
    if (!value.isCompressed()) {
      auto compressed = value;
      compressed.makeCompressed();
      return walk(wire, compressed);
    }
    std::array<Index, 3> size{value.rows(), value.cols(), value.nonZeros()};
    walk(wire, size);
    if constexpr (receives) {
      wire.require(static_cast<std::size_t>(size[2]), sizeof(double));
      value.resize(size[0], size[1]);
      value.resizeNonZeros(size[2]);
    }
    const auto count = static_cast<std::size_t>(size[2]);
    wire.move(value.outerIndexPtr(), sizeof(int) * static_cast<std::size_t>(value.outerSize() + 1));
    wire.move(value.innerIndexPtr(), sizeof(int) * count);
    wire.move(value.valuePtr(), sizeof(double) * count);
  } else if constexpr (requires { value.data(); }) {
    using Element = std::remove_cvref_t<decltype(*value.data())>;
    auto count = value.size();
    walk(wire, count);
    if constexpr (receives) {
      // What is not sent as it lies in memory can be shorter on the wire: a byte at least.
      wire.require(static_cast<std::size_t>(count), std::is_trivially_copyable_v<Element> ? sizeof(Element) : 1);
      value.resize(count);
    }
    if constexpr (std::is_trivially_copyable_v<Element>)
      wire.move(value.data(), sizeof(Element) * static_cast<std::size_t>(count));
    else
      for (auto& element : value) walk(wire, element);
  } else {
    fields([&wire](auto&... all) { (walk(wire, all), ...); }, value);
  }
}

template <class T>
std::string pack(const T& value) {
  Outgoing out;
  walk(out, value);
  return std::move(out.bytes);
}

// Throws std::runtime_error where the bytes end too early.
template <class T>
T unpack(std::string_view bytes) {
  Incoming in{bytes};
  T value;
  walk(in, value);
  return value;
}

}  // namespace zwang
