#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include <zwang/core/problem/instance.h>

namespace zwang {

// SHA-256 over the sources that a reference depends on, the compiler, its flags and the versions of Eigen, mpfr and
// gmp, 64 hexadecimal digits; sources_hash.cmake takes it at each
// build. It is part of an entry's name: what other sources computed is never read.
extern const std::string_view reference_sources;

// One file a reference: its numbers as wire.h sends them, and a checksum. Written beside its place and renamed, so
// that a reader never sees half a file.
void write_cached(const std::filesystem::path& file, const Reference& reference);

// Empty when the file is absent, torn or altered.
std::optional<Reference> read_cached(const std::filesystem::path& file);

}  // namespace zwang
