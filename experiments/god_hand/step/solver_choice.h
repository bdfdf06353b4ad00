#pragma once

#include <zwang/core/problem/solver.h>
#include <zwang/core/referee/measure.h>
#include <zwang/experiments/god_hand/step/options.h>

namespace zwang::god {

// The solver that the options name; with `maximal` its setting "reduce", where it has one, is off. Throws
// std::invalid_argument with the nearest name.
AnySolver solver_of(const Options& options);

// Is there a z to use? Also the last iterate of a method that stopped early: the sweep stops what is wrong about it.
bool has_answer(const Problem& problem, const Solution& solution);

// Multipliers by least squares, where the method gives none: forces are read from them.
void complete_multipliers(const Problem& problem, Solution& solution);

Status worse(Status a, Status b);
// An infeasibility that is proven is no fault: rows that push out of a wedge may contradict each other.
Verdict worse(Verdict a, Verdict b);

}  // namespace zwang::god
