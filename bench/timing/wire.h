#pragma once

#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include <zwang/bench/timing/solve_service.h>

namespace zwang {

// What parent and child process say to each other: native-endian bytes, both ends being the same program.
class Outgoing {
 public:
  template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void put(const T& value) {
    append(&value, sizeof value);
  }
  template <class T>
  void put(const T* data, std::size_t count) {
    put(count);
    append(data, count * sizeof(T));
  }
  void put(const std::string& text) { put(text.data(), text.size()); }
  void put(const Vector& v) { put(v.data(), static_cast<std::size_t>(v.size())); }

  const std::vector<char>& bytes() const { return bytes_; }

 private:
  void append(const void* data, std::size_t size) {
    bytes_.resize(bytes_.size() + size);
    if (size > 0) std::memcpy(bytes_.data() + bytes_.size() - size, data, size);
  }
  std::vector<char> bytes_ = {};
};

// Reads in the order of writing. Throws std::runtime_error past the end.
class Incoming {
 public:
  explicit Incoming(std::vector<char> bytes) : bytes_(std::move(bytes)) {}

  template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  T get() {
    T value;
    take(&value, sizeof value);
    return value;
  }
  // A std::string, std::vector of numbers or Vector: its length, then its entries.
  template <class Container>
  Container get_all() {
    const auto count = get<std::size_t>();
    require(count, sizeof(*std::declval<Container>().data()));
    Container out;
    out.resize(static_cast<decltype(out.size())>(count));
    take(out.data(), count * sizeof(*out.data()));
    return out;
  }

 private:
  void require(std::size_t count, std::size_t size) const;
  void take(void* to, std::size_t size);

  std::vector<char> bytes_;
  std::size_t at_ = 0;
};

void put(Outgoing& out, const Problem& problem);
void put(Outgoing& out, const SolveRequest& call);
void put(Outgoing& out, const SolveReply& answer);
Problem get_problem(Incoming& in);
SolveRequest get_call(Incoming& in);
SolveReply get_answer(Incoming& in);

}  // namespace zwang
