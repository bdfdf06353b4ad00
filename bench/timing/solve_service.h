#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <zwang/core/problem/preparation.h>
#include <zwang/core/problem/solver.h>
#include <zwang/core/process/wire.h>

namespace zwang {

// "nnls" or "nnls:key=value" -> solver; throws std::invalid_argument.
using MakeSolver = std::function<AnySolver(std::string_view text)>;

// One request to solve a problem and to time it.
struct SolveRequest {
  std::string solver = {};  // as given on the command line
  double tolerance = 1e-10;
  std::string accuracy = {};      // SolveOptions::read_accuracy
  double time_limit = 1;          // s of CPU time, for one solve
  int max_iterations = 1000000;   // in the method's own unit
  int solves = 1;                 // solves between the two readings of the clock
  bool fresh = false;             // build the solver anew: its first solve includes allocations and analyses
  bool warm_up = false;           // one untimed solve first, to fill the caches
  bool observe = false;           // keep iterates (never in timed calls)
  WarmStart warm = {};            // the frame before; no keys: a cold solve
  NullSpaceForm* form = nullptr;  // SolveOptions::form; of a solve in this process
};

struct SolveReply {
  Solution solution = {};
  double seconds = 0;                  // CPU time of one solve
  double prepare_s = 0;                // of that, what brought the problem into the method's form
  double allocations = 0;              // heap blocks that one solve asked for
  std::vector<Iterate> iterates = {};  // at the rungs, when observed
};

void fields(auto visit, same_but_const<SolveRequest> auto& x) {
  visit(x.solver, x.tolerance, x.accuracy, x.time_limit, x.max_iterations, x.solves, x.fresh, x.warm_up, x.observe,
        x.warm);
}
void fields(auto visit, same_but_const<SolveReply> auto& x) {
  visit(x.solution, x.seconds, x.prepare_s, x.allocations, x.iterates);
}

// Whether convergence rows are taken at this iteration: 0, 1, 2, 3, 4, 6, 8, 12, 16, 24, ... and so on.
bool is_rung(int iteration);

// Solvers by their text, kept from call to call, so that a repeated solve finds its storage allocated. The suite has
// one for native solvers; a child process has one for foreign solvers. An exception of a backend is a numerical
// failure with the exception's words, as a status like any other.
class SolveService {
 public:
  explicit SolveService(MakeSolver make) : make_(std::move(make)) {}
  SolveReply run(const Problem& problem, const SolveRequest& call);

 private:
  AnySolver& solver(const SolveRequest& call);

  MakeSolver make_;
  std::map<std::string, AnySolver, std::less<>> kept_ = {};
};

}  // namespace zwang
