#include <zwang/bench/references/cache.h>

#include <fstream>
#include <iterator>

#include <zwang/core/files/stored_file.h>
#include <zwang/core/problem/mix_bits.h>
#include <zwang/core/process/wire.h>

namespace zwang {

void fields(auto visit, same_but_const<Reference> auto& x) {
  visit(x.feasible, x.z, x.lambda, x.certificate, x.bound, x.unique, x.method);
}

void write_cached(const std::filesystem::path& file, const Reference& r) {
  const std::string bytes = pack(r);
  std::filesystem::create_directories(file.parent_path());
  replace_file(file, bytes + pack(fnv1a(bytes)));
}

std::optional<Reference> read_cached(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (bytes.size() < sizeof(std::uint64_t)) return {};
  const std::string_view body(bytes.data(), bytes.size() - sizeof(std::uint64_t));
  if (unpack<std::uint64_t>({body.end(), sizeof(std::uint64_t)}) != fnv1a(body)) return {};
  try {
    return unpack<Reference>(body);
  } catch (const std::runtime_error&) {
    return {};
  }
}

}  // namespace zwang
