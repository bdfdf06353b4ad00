#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace zwang {

// The points of the stability atlas (docs/stability.md) as certified problem files: one HDF5 file a point (NPE_k=27.h5)
// with its reference, by two witnesses where n <= 96, and atlas.tsv with a line for each:
//
//   file  problem  n  m  sha256  feasible  method  bound  |z*|_M
//
// The same call gives the same bytes. `families`: "NPE,WED", or "" for all. `cache`: of references (suite.h), or "".
// `progress` is told before each point: how many are done, of how many, and its name. Returns how many there are.
// Throws std::runtime_error where a reference cannot be had or witnesses disagree, BadFile where a file cannot be
// written.
std::size_t write_atlas(const std::filesystem::path& directory, const std::string& families,
                        const std::filesystem::path& cache,
                        const std::function<void(std::size_t, std::size_t, const std::string&)>& progress);

}  // namespace zwang
