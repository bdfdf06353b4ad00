#pragma once

#include <zwang/solvers/finish/extended_polish.h>

namespace zwang {

// From a guess of the active set to an answer that holds in extended precision: extended_polish.h with residuals in
// long double, and again, from the rows that these end with, in double-double, where long double decides nothing or
// leaves z in doubt. Joints 2^-27 apart lose 2^-64 / 2^-27 in long double and are right to the last bit of a double in
// double-double, as long as the double factors contract: to 2^-45.
class Polish : public ExtendedPolish<FactorReal> {
 public:
  bool run(const Problem& problem, const Whitened& rows, ActiveRows& active, const SolveOptions& options,
           Solution& solution);
  // For methods that stand alone (polish=off): the status that the z and lambda in `solution` deserve, which stay as
  // they are, beside the polished answer from these active rows. Changes active.
  void judge(const Problem& problem, const Whitened& rows, ActiveRows& active, const SolveOptions& options,
             Solution& solution);

 private:
  ExtendedPolish<DoubleDouble> double_double_;
  Solution first_, polished_;
  Vector off_;
};

}  // namespace zwang
