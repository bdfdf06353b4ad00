#pragma once

#include <zwang/core/referee/measure.h>
#include <zwang/core/referee/scaled_problem.h>

namespace zwang {

// measure() of a z for problems with tangent rows, under the law that the problem states. docs/referee.md says what
// each verdict asks for. `reference` may be null; under Coulomb's law it counts only where it is the one solution.
Verdict judge_friction(const Problem& problem, const ScaledProblem& scaled, const Solution& solution,
                       const Reference* reference, double tolerance, Metrics& out);

// Is it proven that a problem with tangent rows has a solution, however far? `motion_scale`: s.
bool proven_feasible(const Problem& problem, const ScaledProblem& scaled, double motion_scale);

}  // namespace zwang
