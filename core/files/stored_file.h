#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <zwang/core/problem/bad_file.h>

namespace zwang {

// A file's bytes as they are stored.
struct StoredFile {
  std::filesystem::path path = {};
  std::string bytes = {};

  // The extension in lower case, ".gz" left out: ".stl" of part.STL.gz.
  std::string kind() const;
  bool packed() const;  // by its name: .gz
};

// Throws BadFile, also for what is no regular file (a folder, a pipe, a device) and for an empty one.
StoredFile read_stored(const std::filesystem::path& file);

// The contents: the bytes, or what they unpack to. Throws BadFile where that is no gzip or more than `most` bytes.
std::string unpacked(const StoredFile& file, std::size_t most);

// Replaces the file in one step: a killed program leaves the old one or the new one. Throws BadFile.
void replace_file(const std::filesystem::path& file, std::string_view bytes);

// 64 hexadecimal digits.
std::string sha256(std::string_view bytes);

}  // namespace zwang
