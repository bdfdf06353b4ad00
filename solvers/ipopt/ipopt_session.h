#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <zwang/core/problem/deadline.h>
#include <zwang/core/problem/solver.h>

namespace zwang {

// What Ipopt is asked: minimize 1/2 |y|^2 with s = G y - h, the first 3 `cones` rows by threes in the cones
// s_0 >= |(s_1, s_2)|, the others s >= 0, or s = 0; and how far to go.
struct IpoptQuestion {
  RowMatrix G = {};
  Vector h = {};
  std::vector<char> equality = {};  // row by row
  Index cones = 0;
  double inside = 0;  // by how much, at least, s starts inside its cone
  Vector start = {};  // y
  double tolerance = 0;
  int max_iterations = 0;
  bool mehrotra = false;
  Deadline deadline = Deadline();
  std::function<double(const Vector& y, const Vector& lambda)> residual = nullptr;
  std::function<void(int iteration, const Vector& y, const Vector& lambda)> observe = nullptr;
};

// What came back, in Ipopt's own judgement; lambda over the rows asked about.
struct IpoptAnswer {
  struct Iterate {
    Vector y, lambda;
    double residual = std::numeric_limits<double>::infinity();
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
