#pragma once

#include <filesystem>

namespace zwang {

// Where problems, parts and recordings lie that are no part of the project: in the folder of the
// environment variable ZWANG_DATA, which ./zwang sets to ../shared/data. May be absent; messages then show the
// variable.
std::filesystem::path recorded_data();

}  // namespace zwang
