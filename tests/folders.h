#pragma once

#include <filesystem>
#include <string>

namespace zwang {

// The root of the source tree that the tests were built from.
std::filesystem::path source_dir();

// A path in the folder for temporary files that no other process has, for cases run beside each other; removed at the
// end.
std::filesystem::path own_path(const std::string& name);

}  // namespace zwang
