#include <zwang/experiments/god_hand/run/replay_page.h>

#include <zwang/bench/report/page/page.h>

// replay.html, bundled like the report's page.
asm(R"(
  .pushsection .rodata
  .global zwang_replay_page
  .global zwang_replay_page_end
zwang_replay_page:
  .incbin ")" ZWANG_REPLAY_PAGE R"("
zwang_replay_page_end:
  .byte 0
  .popsection
)");
extern "C" const char zwang_replay_page[];
extern "C" const char zwang_replay_page_end[];

namespace zwang::report {

std::string replay_page(const std::string& data) {
  return filled({zwang_replay_page, static_cast<std::size_t>(zwang_replay_page_end - zwang_replay_page)}, data);
}

}  // namespace zwang::report
