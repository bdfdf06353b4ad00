#pragma once

#include <zwang/core/referee/friction/contact_problem.h>
#include <zwang/core/referee/friction/friction_metrics.h>

namespace zwang {

// The residuals of an answer, in the units of a ContactProblem. lambda may be null: then penetration alone is known.
FrictionMetrics friction_residuals(const ContactProblem& problem, Law law, const ExtendedVector& x,
                                   const ExtendedVector* lambda);

}  // namespace zwang
