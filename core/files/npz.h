#pragma once

#include <string>
#include <vector>

#include <zwang/core/files/stored_file.h>

namespace zwang {

// An array of numpy.savez: numbers of any of NumPy's usual types, or one text.
struct NamedArray {
  std::string name = {};
  bool is_text = false, is_scalar = false;
  std::vector<double> numbers = {};
  std::string text = {};  // UTF-8
};

// By its first bytes: a zip archive.
bool is_npz(const StoredFile& file);

// The arrays of numpy.savez or savez_compressed, with at most one dimension, in the archive's order. Throws BadFile,
// one line with file, array and what was expected: no archive, a member cut off or whose checksum differs, a name that
// comes twice, Python objects.
std::vector<NamedArray> read_npz(const StoredFile& file);

}  // namespace zwang
