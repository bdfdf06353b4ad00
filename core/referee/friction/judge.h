#pragma once

#include <zwang/core/referee/measure.h>
#include <zwang/core/referee/scaled_problem.h>

namespace zwang {

// measure() for problems with tangent rows, under the law that the problem states. docs/referee.md says what each
// verdict asks for. `reference` may be null; under Coulomb's law it counts only where it is the one solution.
Verdict judge_friction(const Problem& problem, const ScaledProblem& scaled, const Solution& solution,
                       const Reference* reference, double tolerance, Metrics& out);

}  // namespace zwang
