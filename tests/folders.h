#pragma once

#include <filesystem>

namespace zwang {

// The root of the source tree that the tests were built from.
std::filesystem::path source_dir();

}  // namespace zwang
