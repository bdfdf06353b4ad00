#include <zwang/bench/report/page/collision_page.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/bench/report/page/embedded.h>
#include <zwang/bench/report/page/page.h>
#include <zwang/core/files/stored_file.h>

// collision.html, bundled like the report's page.
ZWANG_EMBEDDED(collision_page, ZWANG_COLLISION_PAGE)

namespace zwang::report {

std::filesystem::path write_collision_report(const std::filesystem::path& dir) {
  const std::filesystem::path from = dir / "collision.json", to = dir / "report.html";
  std::ifstream in(from);
  nlohmann::json results;
  try {
    results = nlohmann::json::parse(in);
  } catch (const nlohmann::json::exception&) {
    throw std::runtime_error(from.string() + ": not the results of a collision run");
  }
  replace_file(to, filled(collision_page(), results.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)));
  return to;
}

}  // namespace zwang::report
