#pragma once

#include <optional>
#include <string>

#include <zwang/core/problem/instance.h>

namespace zwang {

// Goldfarb & Idnani's method in 100-digit mpfr arithmetic (wide_active_set.h): z*, lambda* or a certificate, each rounded
// once, after KktCertificate has proven them with all their digits. Empty when M is not positive definite, or when the
// certificate refuses the answer; `why_not` then says which.
std::optional<Reference> multiprecision_reference(const Problem& problem, std::string* why_not = nullptr);

// The same method in long double, accepted as far as the referee proves it from the stored doubles: `bound` is its
// active-set bound, in double-double arithmetic. Empty where there is none or it exceeds 1e-9, and on problems the
// method calls infeasible: nothing certifies those here.
std::optional<Reference> extended_reference(const Problem& problem);

// CGAL's exact rational simplex-like QP solver: shares no code and no arithmetic with the above. No multipliers.
// Without CGAL, which is under the GPL, always empty.
std::optional<Reference> rational_reference(const Problem& problem);
extern const bool has_rational_reference;

// What the referee proves of a reference's stored doubles, without any reference. certified: z is within `bound` of a
// solution, relative to s; that is at most what the reference states and its rounding.
enum class Standing { certified, refuted, open };
struct StoredTruth {
  Standing standing = Standing::open;
  double bound = 0;
};
StoredTruth check_stored(const Problem& problem, const Reference& reference);

// Bounds |z - z*|_M / s where each entry of z is that of z* rounded once.
double rounding_of(const Problem& problem, const Vector& z);

// |a - b|_M / max(|z_u|_M, |a|_M).
double relative_distance(const Problem& problem, const Vector& a, const Vector& b);

}  // namespace zwang
