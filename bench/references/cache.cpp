#include <zwang/bench/references/cache.h>

#include <unistd.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>

#include <zwang/core/problem/mix_bits.h>

namespace zwang {
namespace {

constexpr std::string_view magic = "zwang reference 1\n";

template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}
void put(std::string& bytes, const Vector& v) {
  put(bytes, static_cast<std::int64_t>(v.size()));
  bytes.append(reinterpret_cast<const char*>(v.data()), sizeof(double) * static_cast<std::size_t>(v.size()));
}

// Takes values off the front; throws std::out_of_range at the end.
struct Reader {
  std::string_view rest;

  std::string_view take(std::size_t count) {
    if (count > rest.size()) throw std::out_of_range("torn");
    const std::string_view bytes = rest.substr(0, count);
    rest.remove_prefix(count);
    return bytes;
  }
  template <class T>
  T value() {
    T v;
    take(sizeof(T)).copy(reinterpret_cast<char*>(&v), sizeof(T));
    return v;
  }
  Vector vector() {
    const auto size = static_cast<std::uint64_t>(value<std::int64_t>());
    if (size > rest.size() / sizeof(double)) throw std::out_of_range("torn");
    const std::string_view bytes = take(size * sizeof(double));
    Vector v(static_cast<Index>(size));
    if (size > 0) std::memcpy(v.data(), bytes.data(), bytes.size());
    return v;
  }
};

}  // namespace

void write_cached(const std::filesystem::path& file, const Reference& r) {
  std::string bytes(magic);
  put(bytes, static_cast<char>(r.feasible));
  put(bytes, r.bound);
  put(bytes, static_cast<std::int64_t>(r.method.size()));
  bytes += r.method;
  for (const Vector* v : {&r.z, &r.lambda, &r.certificate}) put(bytes, *v);
  put(bytes, fnv1a(bytes));

  std::filesystem::create_directories(file.parent_path());
  const std::filesystem::path beside = file.string() + "." + std::to_string(::getpid());
  {
    std::ofstream out(beside, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) throw std::runtime_error(beside.string() + ": cannot be written");
  }
  std::filesystem::rename(beside, file);
}

std::optional<Reference> read_cached(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (bytes.size() < magic.size() + sizeof(std::uint64_t)) return {};
  const std::string_view body = std::string_view(bytes).substr(0, bytes.size() - sizeof(std::uint64_t));
  if (Reader{std::string_view(bytes).substr(body.size())}.value<std::uint64_t>() != fnv1a(body)) return {};
  try {
    Reader reader{body};
    if (reader.take(magic.size()) != magic) return {};
    Reference r;
    r.feasible = reader.value<char>() != 0;
    r.bound = reader.value<double>();
    r.method = reader.take(static_cast<std::size_t>(reader.value<std::int64_t>()));
    for (Vector* v : {&r.z, &r.lambda, &r.certificate}) *v = reader.vector();
    return r;
  } catch (const std::out_of_range&) {
    return {};
  }
}

}  // namespace zwang
