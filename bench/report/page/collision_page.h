#pragma once

#include <filesystem>

namespace zwang::report {

// DIR/collision.json -> DIR/report.html, one page that needs nothing beside it. Returns its path; throws
// std::runtime_error when the file cannot be read or written.
std::filesystem::path write_collision_report(const std::filesystem::path& dir);

}  // namespace zwang::report
