#pragma once

#include <zwang/core/problem/solver.h>

namespace zwang {

// What the dense parts of a solver take, asked for before they are allocated: a problem of 20000 unknowns and 30000
// rows has 4.8 GB of whitened rows and 16 GB of factors, and a kernel out of memory kills where an allocation fails too
// late.
class DenseStorage {
 public:
  // Throws Stopped (a numerical failure, with the sizes) where `numbers` doubles, in place of those granted before, are
  // more than options.memory_limit or than is free. Below 256 MB the machine is not asked.
  void require(double numbers, const SolveOptions& options);

 private:
  double granted_ = 0;  // bytes
};

}  // namespace zwang
