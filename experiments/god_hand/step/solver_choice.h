#pragma once

#include <zwang/core/problem/solver.h>
#include <zwang/core/referee/measure.h>
#include <zwang/experiments/god_hand/step/options.h>

namespace zwang::god {

// The solver that the options name; with `maximal` its setting "reduce", where it has one, is off. Throws
// std::invalid_argument with the nearest name.
AnySolver solver_of(const Options& options);

// The one for problems without tangent rows: the same, unless there is friction and the exact one is faster at it.
AnySolver plain_solver_of(const Options& options);

// What a frame asks of a solve: of `cone` few iterations, since under Coulomb's law there may be no answer.
SolveOptions asked_of(const Problem& problem, const Options& options, const WarmStart& warm);

// The rows of the last `contacts` constraints of a problem, which are contacts: the first one of each.
void first_rows(const Problem& problem, std::size_t contacts, std::vector<Index>& rows);

// Is there a z to use? Also the last iterate of a method that stopped early: the sweep stops what is wrong about it.
// With friction also the best iterate of one that failed: there may be no exact answer under Coulomb's law.
bool has_answer(const Problem& problem, const Solution& solution);

// Multipliers by least squares, where the method gives none: forces are read from them.
void complete_multipliers(const Problem& problem, Solution& solution);

Status worse(Status a, Status b);

}  // namespace zwang::god
