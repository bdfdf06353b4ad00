#include <zwang/bench/report/page/page.h>

#include <stdexcept>

#include <zwang/core/files/embedded.h>

// The pages, which bundle.mjs makes of templates, libraries and chart specs, are part of the program: writing a report
// needs neither Node nor a file beside it.
ZWANG_EMBEDDED(report_html, ZWANG_REPORT_PAGE)
ZWANG_EMBEDDED(collision_html, ZWANG_COLLISION_PAGE)
ZWANG_EMBEDDED(league_html, ZWANG_LEAGUE_PAGE)

namespace zwang::report {

std::string page(std::string_view kind, const std::string& data) {
  if (kind == "run") return filled(report_html(), data);
  if (kind == "collision") return filled(collision_html(), data);
  if (kind == "league") return filled(league_html(), data);
  if (kind != "large") throw std::invalid_argument("no page '" + std::string(kind) + "'");
  constexpr std::string_view inline_alone = "script-src 'unsafe-inline'";
  std::string whole = filled(report_html(), data);
  return whole.replace(whole.find(inline_alone), inline_alone.size(), "script-src 'unsafe-inline' 'self' file:");
}

std::string filled(std::string_view whole, const std::string& data) {
  constexpr std::string_view slot = "{\"slot\":\"data\"}";
  const std::size_t at = whole.find(slot);
  if (at == std::string_view::npos) throw std::logic_error("the embedded report page has no place for its data");
  std::string out(whole.substr(0, at));
  out.reserve(whole.size() + data.size());
  for (const char ch : data) out += ch == '<' ? "\\u003c" : std::string_view(&ch, 1);  // no "</script" may end it
  out += whole.substr(at + slot.size());
  return out;
}

}  // namespace zwang::report
