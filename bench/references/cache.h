#pragma once

#include <filesystem>
#include <optional>

#include <zwang/core/problem/instance.h>

namespace zwang {

// One file a reference: a line of text, the sizes, the doubles bit for bit, a checksum. Written beside its place and
// renamed, so that a reader never meets half a file.
void write_cached(const std::filesystem::path& file, const Reference& reference);

// Empty when the file is absent, torn, altered or of another version.
std::optional<Reference> read_cached(const std::filesystem::path& file);

}  // namespace zwang
