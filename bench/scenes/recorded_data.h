#pragma once

#include <filesystem>

namespace zwang {

// Where problems, parts and recordings lie that are no part of the project: $ZWANG_DATA, or ../shared/data beside it.
// May be absent.
std::filesystem::path recorded_data();

}  // namespace zwang
