#include <zwang/bench/packs/xml.h>

namespace zwang {

std::string in_xml(const std::string& text) {
  std::string out;
  for (const char ch : text) switch (ch) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += ch;
    }
  return out;
}

std::string junit(const std::vector<XmlCase>& cases) {
  std::string body;
  std::size_t failures = 0, skipped = 0;
  for (const XmlCase& c : cases) {
    body += "  <testcase classname=\"" + in_xml(c.group) + "\" name=\"" + in_xml(c.name) + "\"";
    if (!c.failure.empty())
      body += "><failure message=\"" + in_xml(c.failure) + "\"/></testcase>\n";
    else if (c.remark == "skipped")
      body += "><skipped/></testcase>\n";
    else if (!c.remark.empty())
      body += "><system-out>" + in_xml(c.remark) + "</system-out></testcase>\n";
    else
      body += "/>\n";
    failures += !c.failure.empty();
    skipped += c.failure.empty() && c.remark == "skipped";
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"zwang\" tests=\"" +
         std::to_string(cases.size()) + "\" failures=\"" + std::to_string(failures) + "\" skipped=\"" +
         std::to_string(skipped) + "\">\n" + body + "</testsuite>\n";
}

}  // namespace zwang
