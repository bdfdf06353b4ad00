#pragma once

#include <limits>

// What more than one native solver decides by. Lengths and pivots are of unit rows.

namespace zwang::tolerances {

// In epsilons of the scalar: what is left of a row that depends on others. Unit rows come out of whitening with an
// error of a few epsilons; so do remainders that should be zero.
inline constexpr int rank = 64;
// In epsilons of the scalar, of the terms of a row: a violation. With 64, contradictions of 2^-42 (families GAP, INC)
// pass as feasible; with 8 those of 2^-45 and less still do.
inline constexpr int violation = 8;
// In epsilons of the wider scalar that answers are refined in: a violation of a row that is not active.
inline constexpr int wide_violation = 32;

// Fast paths leave problems with smaller pivots to careful ones.
inline constexpr double clear_pivot = 1e-6;
// A dropped row of which more is left was not dropped by rounding alone: exactly dependent ones leave up to 2.4e-15 on
// 300 random hands.
inline constexpr double clear_rest = 4e-15;

// A contradiction counts where every motion that met the rows would be so many times as long as the longest there is:
// the referee's 1e8 (core/referee/certificate.h), and as much again for the rounding between.
inline constexpr double out_of_reach = 2e8;

}  // namespace zwang::tolerances
