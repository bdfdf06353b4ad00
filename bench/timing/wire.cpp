#include <zwang/bench/timing/wire.h>

#include <array>
#include <cstring>
#include <stdexcept>
#include <type_traits>

namespace zwang {
namespace {

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

// The fields of each type, in one list for both directions.
template <class Visit>
void fields(Visit visit, auto& x) {
  if constexpr (requires { x.z_u; })
    visit(x.name, x.M, x.z_u, x.J, x.c, x.kind, x.key);
  else if constexpr (requires { x.solves; })
    visit(x.solver, x.tolerance, x.time_limit, x.max_iterations, x.solves, x.fresh, x.warm_up, x.observe, x.warm.key,
          x.warm.lambda);
  else if constexpr (requires { x.iterates; })
    visit(x.solution, x.seconds, x.prepare_s, x.allocations, x.iterates);
  else if constexpr (requires { x.certificate; })
    visit(x.status, x.z, x.lambda, x.iterations, x.certificate, x.redundant, x.margins, x.fallback, x.range_gap,
          x.handed_to, x.message);
  else
    visit(x.iteration, x.z, x.lambda);
}

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
      wire.require(static_cast<std::size_t>(count), sizeof(Element));
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

}  // namespace

template <class T>
std::string pack(const T& value) {
  Outgoing out;
  walk(out, value);
  return std::move(out.bytes);
}

template <class T>
T unpack(std::string_view bytes) {
  Incoming in{bytes};
  T value;
  walk(in, value);
  return value;
}

template std::string pack(const Problem&);
template std::string pack(const SolveRequest&);
template std::string pack(const SolveReply&);
template Problem unpack(std::string_view);
template SolveRequest unpack(std::string_view);
template SolveReply unpack(std::string_view);

}  // namespace zwang
