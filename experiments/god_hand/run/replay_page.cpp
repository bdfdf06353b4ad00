#include <zwang/experiments/god_hand/run/replay_page.h>

#include <zwang/bench/report/page/embedded.h>
#include <zwang/bench/report/page/page.h>

// replay.html, bundled like the report's page.
ZWANG_EMBEDDED(replay_html, ZWANG_REPLAY_PAGE)

namespace zwang::report {

std::string replay_page(const std::string& data) { return filled(replay_html(), data); }

}  // namespace zwang::report
