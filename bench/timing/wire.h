#pragma once

#include <string>
#include <string_view>

#include <zwang/bench/timing/solve_service.h>

namespace zwang {

// What parent and child process say to each other: native-endian bytes, both ends being the same program.
// T: Problem, SolveRequest, SolveReply. unpack throws std::runtime_error where the bytes end too early.
template <class T>
std::string pack(const T& value);
template <class T>
T unpack(std::string_view bytes);

}  // namespace zwang
