#pragma once

#include <string>

namespace zwang {

// Of instruction_sets.def.
enum InstructionSet : unsigned {
#define INSTRUCTION_SET(bit, name, ...) name = bit,
#include <zwang/bench/timing/instruction_sets.def>
#undef INSTRUCTION_SET
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
