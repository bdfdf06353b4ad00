#include <zwang/bench/references/cache.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include <zwang/core/files/stored_file.h>
#include <zwang/core/problem/mix_bits.h>

namespace zwang {
namespace {

using Json = nlohmann::json;

Vector vector(const Json& numbers) {
  const auto values = numbers.get<std::vector<double>>();
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

}  // namespace

void write_cached(const std::filesystem::path& file, const Reference& r) {
  std::string bytes;
  Json::to_cbor({{"feasible", r.feasible},
                 {"bound", r.bound},
                 {"unique", r.unique},
                 {"method", r.method},
                 {"z", r.z},
                 {"lambda", r.lambda},
                 {"certificate", r.certificate}},
                bytes);
  const std::uint64_t checksum = fnv1a(bytes);
  bytes.append(reinterpret_cast<const char*>(&checksum), sizeof checksum);

  std::filesystem::create_directories(file.parent_path());
  replace_file(file, bytes);
}

std::optional<Reference> read_cached(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  std::uint64_t checksum;
  if (bytes.size() < sizeof checksum) return {};
  const std::string_view body(bytes.data(), bytes.size() - sizeof checksum);
  std::memcpy(&checksum, body.end(), sizeof checksum);
  if (checksum != fnv1a(body)) return {};
  try {
    const Json j = Json::from_cbor(body);
    return Reference{.feasible = j.at("feasible"),
                     .z = vector(j.at("z")),
                     .lambda = vector(j.at("lambda")),
                     .certificate = vector(j.at("certificate")),
                     .bound = j.at("bound"),
                     .unique = j.at("unique"),
                     .method = j.at("method")};
  } catch (const Json::exception&) {
    return {};
  }
}

}  // namespace zwang
