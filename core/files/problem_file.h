#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <zwang/core/problem/bad_file.h>
#include <zwang/core/problem/instance.h>
#include <zwang/core/problem/law.h>

namespace zwang {

// Reads every problem of an HDF5 file: zwang's own layout, FCLIB (local or global), and collections of either
// (one group a problem, in the natural order of their names, with optional truth/); or Siconos' text, .dat.
// docs/formats.md. Every problem has passed bad_input and has a positive definite M. Throws BadFile. Not for threads.
//
// `law`: the law that contacts with friction are stated under (law.h); none: the file's own, which is Coulomb's unless
// it says another.
std::vector<Instance> read_problems(const std::filesystem::path& file, std::optional<Law> law = {});

// Writes zwang's own layout; every double comes back bit for bit, and the same instance gives the same bytes. The file
// appears under its name only when complete. Throws BadFile.
void write_problem(const std::filesystem::path& file, const Instance& instance);
void write_problems(const std::filesystem::path& file, std::span<const Instance> instances);  // a collection

// SHA-256 over M, z_u, J, c, kind and, where there are tangent rows, mu and the law (canonical bytes): the name of a
// problem's contents, 64 hexadecimal digits.
std::string problem_sha256(const Problem& problem);

}  // namespace zwang
