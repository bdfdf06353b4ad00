#include <zwang/core/problem/bad_file.h>

namespace zwang {

std::string one_line(std::string text) {
  for (char& ch : text)
    if (static_cast<unsigned char>(ch) < ' ' || ch == '\x7f') ch = ' ';
  while (!text.empty() && text.back() == ' ') text.pop_back();
  if (text.size() > 300) text = text.substr(0, 297) + "...";
  return text;
}

}  // namespace zwang
