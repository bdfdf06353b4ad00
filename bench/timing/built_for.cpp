#include <zwang/bench/timing/instruction_set.h>

namespace zwang {

// Compiled with the flags of all other sources; a constant, so that reading it runs no instruction of theirs.
const unsigned built_for = 0
#ifdef __SSE4_2__
                           | sse4_2
#endif
#ifdef __AVX__
                           | avx
#endif
#ifdef __AVX2__
                           | avx2
#endif
#ifdef __FMA__
                           | fma
#endif
#ifdef __BMI2__
                           | bmi2
#endif
#ifdef __AVX512F__
                           | avx512f
#endif
#ifdef __AVX512DQ__
                           | avx512dq
#endif
#ifdef __AVX512VL__
                           | avx512vl
#endif
    ;

}  // namespace zwang
