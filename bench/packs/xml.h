#pragma once

#include <string>
#include <vector>

namespace zwang {

std::string in_xml(const std::string& text);  // &, <, > and " by their names

// JUnit's XML, as continuous integration reads it.
struct XmlCase {
  std::string group = {}, name = {};
  std::string failure = {};  // "": passed
  std::string remark = {};   // of one that is neither: "skipped", or what is said of it
};
std::string junit(const std::vector<XmlCase>& cases);

}  // namespace zwang
