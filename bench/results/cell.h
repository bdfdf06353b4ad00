#pragma once

#include <string>

namespace zwang {

// What names one cell of a suite: one solver on one problem at one tolerance.
struct CellKey {
  std::string problem_file = {}, problem_sha256 = {};  // its place in the suite, its contents
  std::string solver = {};                             // settings included
  double tolerance = 0;

  // 32 hexadecimal digits, from these and the commit of the program.
  std::string name(const std::string& commit) const;
};

// "problems/0007.h5": the file of a suite's problem.
std::string problem_file(std::size_t position);

}  // namespace zwang
