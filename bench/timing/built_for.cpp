#include <zwang/bench/timing/instruction_set.h>

namespace zwang {

// "1" where the compiler defines `x`, and "x" where it does not.
#define TEXT_OF(x) #x

// Compiled with the flags of all other sources; a constant, so that reading it runs no instruction of theirs.
const unsigned built_for = 0
#define INSTRUCTION_SET(bit, name, text, of_cpu, defined) +(TEXT_OF(defined)[0] == '1' ? bit : 0)
#include <zwang/bench/timing/instruction_sets.def>
#undef INSTRUCTION_SET
    ;

}  // namespace zwang
