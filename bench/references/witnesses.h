#pragma once

#include <optional>

#include <zwang/core/problem/instance.h>

namespace zwang {

// Goldfarb & Idnani in 100-digit mpfr arithmetic: z*, lambda* or a certificate, each rounded once. Empty when M is not
// positive definite, or when even 100 digits leave a decision open.
std::optional<Reference> multiprecision_reference(const Problem& problem);

// The same method in long double; the referee's active-set bound says how far z may be off. Empty where that bound
// does not hold or exceeds 1e-9, and on problems it calls infeasible: nothing certifies those here.
std::optional<Reference> extended_reference(const Problem& problem);

// CGAL's exact rational simplex-like QP solver: shares no code and no arithmetic with the above. No multipliers.
std::optional<Reference> rational_reference(const Problem& problem);

// |a - b|_M / max(|z_u|_M, |a|_M), in long double.
double relative_distance(const Problem& problem, const Vector& a, const Vector& b);

}  // namespace zwang
