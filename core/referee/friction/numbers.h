#pragma once

#include <zwang/core/referee/friction/contact_problem.h>
#include <zwang/core/referee/friction/friction_metrics.h>

namespace zwang {

// Normal and tangents of one contact, 0 where there is none.
using ContactVector = Vec<DoubleDouble, 3>;

// Onto K = {|l_t| <= mu l_n}; for mu = 0 or without tangents onto l_n >= 0, l_t = 0.
ContactVector project(const ContactVector& l, double mu);

// The residuals of an answer, in the units of a ContactProblem. lambda may be null: then penetration alone is known.
FrictionMetrics friction_residuals(const ContactProblem& problem, Law law, const ExtendedVector& x,
                                   const ExtendedVector* lambda);

}  // namespace zwang
