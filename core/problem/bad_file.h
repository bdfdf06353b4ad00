#pragma once

#include <stdexcept>
#include <string>

namespace zwang {

// What stands between a user's file and a problem. Its what() is one line: file, place, what was expected.
struct BadFile : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// One line of at most 300 characters without control characters, for what a library or a file says.
std::string one_line(std::string text);

}  // namespace zwang
