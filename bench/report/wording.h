#pragma once

#include <string>

#include <zwang/core/problem/wording.h>

namespace zwang::report {

std::string shell_word(const std::string& word);  // quoted where a shell would read it otherwise

std::string scientific(double value, int digits = 1);  // "3.2e-09", "1e-08" with 0 digits; "unknown" for NaN
std::string duration(double seconds);                  // "18 us", "1.9 ms", "2.4 s"

}  // namespace zwang::report
