#pragma once
#include <cstdlib>
namespace zwang {
inline double knob(const char* name, double standard) {
  const char* s = std::getenv(name);
  return s ? std::atof(s) : standard;
}
}  // namespace zwang
