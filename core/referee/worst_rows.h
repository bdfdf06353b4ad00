#pragma once

#include <string>
#include <vector>

#include <zwang/core/problem/instance.h>

namespace zwang {

// Worst violation per constraint type, in the rows' own units of acceleration (J z - c), with the row that has it.
struct TypeResidual {
  std::string type;  // "contact", "ball_joint", ...
  double violation;  // in the row's own unit
  double relative;   // on the unit row, divided by s
  Index row;
};
std::vector<TypeResidual> worst_by_type(const Instance& instance, const Vector& z);

}  // namespace zwang
