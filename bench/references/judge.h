#pragma once

#include <filesystem>
#include <string>

#include <zwang/core/referee/measure.h>
#include <zwang/core/referee/quadratic_program.h>

namespace zwang {

// What is proven of somebody's z: its distance to the solution z* (under Coulomb's law the nearest of them) lies in
// [at_least, at_most], relative to s = max(|z_u|_M, |z*|_M), in the M-norm. The verdict is measure()'s.
struct Judgement {
  Verdict verdict = Verdict::undecided;
  Metrics metrics = {};  // the referee's residuals, from the problem and z (and lambda) alone
  double at_least = 0, at_most = Metrics::unknown;
  std::string proof = {};                       // how z* is known: a reference's method, or the referee's bound
  std::string worst_row = {};                   // the most violated one; "" where none is
  double scale_over_answer = Metrics::unknown;  // s / |z*|_M: times it, the distance is relative to the answer alone
  std::string text = {};                        // all of it in one line
};

// Judges z, whoever found it. lambda may be empty. The truth is the instance's reference, or one that is found and
// certified here (docs/references.md); without any the verdict rests on the referee's own bound. z is right where the
// distance is at most max(10 tolerance, 1e-12), near up to 1000 times that; of a reference that is one of several
// solutions at_least is what violated rows prove. Throws std::invalid_argument where sizes do not fit.
Judgement judge(const Instance& instance, const Vector& z, const Vector& lambda, double tolerance,
                const std::filesystem::path& cache = {});

// Judges "no z meets the rows", whoever said it, by its certificate (m, or none).
Judgement judge_infeasible(const Instance& instance, const Vector& certificate,
                           const std::filesystem::path& cache = {});

// judge() for x of a quadratic program, in the P-norm; y, z and z_box as in qpsolvers, or empty. The rounding of z_u
// widens the bounds.
Judgement judge(const QuadraticProgram& program, const Vector& x, const Vector& y, const Vector& z, const Vector& z_box,
                double tolerance);

}  // namespace zwang
