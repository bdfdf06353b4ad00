#pragma once

#include <zwang/bench/report/tables/tables.h>

namespace zwang::report {

// One run that holds both: names of solvers in both get " @A" and " @B", problems with the same contents one name.
Run merged(const Run& a, const Run& b);

// Per solver of both runs, on the problems both hold: what is reached at 1e-6, the time ratio, lies.
Table comparison_table(const Run& a, const Run& b);

}  // namespace zwang::report
