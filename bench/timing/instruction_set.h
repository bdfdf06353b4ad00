#pragma once

#include <string>

namespace zwang {

// Instruction sets beyond the first x86-64 that a compiler may use.
enum InstructionSet : unsigned {
  sse4_2 = 1,
  avx = 2,
  avx2 = 4,
  fma = 8,
  bmi2 = 16,
  avx512f = 32,
  avx512dq = 64,
  avx512vl = 128
};

// What this program was compiled for.
extern const unsigned built_for;

// "AVX2, FMA": what is in the first and not in the second; "" where nothing is.
std::string lacking(unsigned built_for, unsigned there);

// Has the program look, before anything else runs, whether this CPU has what it was compiled for: one line and exit
// code 3 where it has not, in place of an illegal instruction somewhere. To be called once from main, so that it is
// linked.
void check_instruction_set();

}  // namespace zwang
