#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/instance.h"

namespace zwang {

// What stands between a user's file and a problem. Its what() is one line: file, place, what was expected.
struct BadFile : std::runtime_error {
  using std::runtime_error::runtime_error;
};

enum class Friction { none, pyramid };  // how FCLIB's tangential directions are read

// Reads every problem of an HDF5 file: zwang's own layout, FCLIB (local or global), and collections of either
// (one group a problem, with optional truth/). docs/formats.md. Throws BadFile.
std::vector<Instance> read_problems(const std::filesystem::path& file, Friction friction = Friction::none);

// Writes one problem in zwang's own layout; every double comes back bit for bit. Throws BadFile.
void write_problem(const std::filesystem::path& file, const Instance& instance);

// SHA-256 over M, z_u, J, c, kind (canonical bytes): the name of a problem's contents, 64 hexadecimal digits.
std::string problem_sha256(const Problem& problem);

}  // namespace zwang
