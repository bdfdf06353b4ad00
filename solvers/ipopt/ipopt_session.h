#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/solvers/form/unit_program.h>
#include <zwang/solvers/friction/cone_program.h>

namespace zwang {

// What Ipopt is asked: the unit program over some of its rows, or a cone program on dense rows, and how far to go.
struct IpoptQuestion {
  const UnitProgram* program = nullptr;
  ConeProgram* cones = nullptr;
  std::vector<Index> rows = {};  // of `program`
  Vector start = {};             // over the unknowns
  double tolerance = 0;
  int max_iterations = 0;
  bool mehrotra = false;
  Deadline deadline = Deadline();
  std::function<void(int, const Vector&, const Vector&)> observe = nullptr;  // iteration, y, lambda
};

// What came back, in Ipopt's own judgement; lambda over all rows of the program.
struct IpoptAnswer {
  struct Iterate {
    Vector y, lambda;
    double residual = std::numeric_limits<double>::infinity();  // kkt_residual, or natural
  };
  Vector y = {}, lambda = {};  // the last point; empty where there is none
  Iterate best = {};           // of the iterates on the way
  int iterations = 0;
  Status status = Status::numerical_failure;  // or infeasible, iteration_limit, time_limit: Ipopt's word
  bool claims_success = false;                // return codes 0, 1 and 3
  bool stuck = false;                         // it could not go on from where it was
  std::string in_words = {};
};

// The library and its options, set up once: registering Ipopt's options takes longer than a small solve.
class IpoptSession {
 public:
  IpoptSession();
  ~IpoptSession();

  IpoptQuestion& question();
  const IpoptAnswer& run();

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace zwang
