#pragma once

#include <cctype>
#include <string>

namespace zwang::test {

// A text as the name of a test: what is neither letter nor digit becomes _.
inline std::string parameter_name(std::string text) {
  for (char& c : text)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return text;
}

}  // namespace zwang::test
