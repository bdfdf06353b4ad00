#pragma once

#include <zwang/bench/report/tables/tables.h>

namespace zwang::report {

// One run that holds both: names of solvers in both get " @A" and " @B", problems with the same contents one name.
RunFolder merged(const RunFolder& a, const RunFolder& b);

// Per solver of both runs, on the problems both hold: what is reached at 1e-6, the time ratio, lies.
Table comparison_table(const RunFolder& a, const RunFolder& b);

}  // namespace zwang::report
