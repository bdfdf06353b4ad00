#pragma once

#include <zwang/core/problem/instance.h>

namespace zwang {

// `solve FILE --solutions`: looks for all solutions of Coulomb's law and prints what was proven, for people or as one
// JSON object. Throws std::invalid_argument where the question makes no sense of this problem.
void print_solutions(const Instance& instance, bool json);

}  // namespace zwang
