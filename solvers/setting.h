#pragma once

#include <string>
#include <string_view>
#include <variant>

namespace zwang {

// One setting of a solver, for the command line: `--solver nnls:max_steps=100`.
template <class S>
struct Setting {
  std::string_view name;
  std::variant<double S::*, int S::*, bool S::*, std::string S::*> member;
  std::string_view help;
};

}  // namespace zwang
