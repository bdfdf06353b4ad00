#pragma once

#include <limits>

#include <zwang/core/problem/solver.h>

namespace zwang {

// Bounds the error of a method's iterates (SolveOptions::accuracy): a theorem but for rounding, for which as much is
// allowed as solvers/friction/promise.h says. It states the rows of any law anew, so methods do not include it: the
// registry gives one to each.
class Prover {
 public:
  virtual ~Prover() = default;
  // Costs nothing. Both are kept until the next begin().
  virtual void begin(const Problem& problem, const SolveOptions& options) = 0;
  // What was asked for of a motion of that length, both in the M-norm in units of 2^exponent. 0: nothing, or not known.
  virtual double enough(double motion, int exponent) const = 0;
  // May a look be had now, that all of them cost a tenth of the method at the most? work: its multiplications so far.
  // left: what the method takes its iterate to be off, relative to the motion. Where that is what was asked for, one
  // look is due at once: it spares the method's end, and the look that this would need. own: the price of a look that
  // the method has itself, where it is not holds() that is asked for.
  virtual bool is_due(double work, double left = std::numeric_limits<double>::infinity(), double own = 0) = 0;
  // From the problem's multipliers. Where the bound is what was asked for, the solution is complete, and solved.
  virtual bool holds(const Vector& lambda, Solution& solution) = 0;
  // The bound with which an answer ends that has none yet (NaN), and may have one; infinite, to a method that handed
  // the problem on, where it may not.
  virtual void end(const Problem& problem, const SolveOptions& options, Solution& solution) = 0;
};

// Begun; null where no accuracy is asked for, or the method stands by itself.
inline Prover* begin_prover(const Problem& problem, const SolveOptions& options) {
  if (!options.has_accuracy() || !options.prover) return nullptr;
  options.prover->begin(problem, options);
  return options.prover;
}

}  // namespace zwang
