#include <zwang/bench/report/page/collision_page.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/bench/report/page/page.h>

// collision.html, bundled like the report's page.
asm(R"(
  .pushsection .rodata
  .global zwang_collision_page
  .global zwang_collision_page_end
zwang_collision_page:
  .incbin ")" ZWANG_COLLISION_PAGE R"("
zwang_collision_page_end:
  .byte 0
  .popsection
)");
extern "C" const char zwang_collision_page[];
extern "C" const char zwang_collision_page_end[];

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
  std::ofstream out(to, std::ios::binary);
  out << filled({zwang_collision_page, static_cast<std::size_t>(zwang_collision_page_end - zwang_collision_page)},
                results.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  out.close();
  if (!out) throw std::runtime_error("cannot write " + to.string());
  return to;
}

}  // namespace zwang::report
