#pragma once

#include <array>

#include <zwang/core/process/other_program.h>
#include <zwang/core/process/wire.h>
#include <zwang/solvers/session.h>
#include <zwang/solvers/setting.h>

namespace zwang {

struct IpoptSettings {
  static constexpr auto name = "ipopt";
  static constexpr std::array laws{Law::convex};

  int max_iterations = 3000;
  bool mehrotra = false;
};

// Ipopt, in a program of its own (zwang-ipopt; solvers/ipopt/ipopt_method.h says how it is asked): its licence, the
// EPL, and that of the parts of SuiteSparse that other solvers link, the GPL, do not go into one program. The time that
// counts is that of the other program; what is said between the two is nobody's.
struct Ipopt : IpoptSettings {
  static std::vector<Setting<Ipopt>> settings() {
    return {{"max_iterations", &Ipopt::max_iterations, "interior-point iterations before giving up"},
            {"mehrotra", &Ipopt::mehrotra, "Mehrotra's predictor-corrector instead of Ipopt's line search"}};
  }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

  Session<OtherProgram> program = {};
};

static_assert(Solver<Ipopt>);

// What is said between the two.
struct IpoptRequest {
  IpoptSettings settings = {};
  double tolerance = 0, time_limit = 0;
  int max_iterations = 0;
  bool observe = false, is_warm = false;
  WarmStart warm = {};
  Problem problem = {};
};
struct IpoptReply {
  Solution solution = {};
  double seconds = 0, prepare_s = 0;  // CPU time
  std::vector<Iterate> iterates = {};
};
void fields(auto visit, same_but_const<IpoptRequest> auto& x) {
  visit(x.settings, x.tolerance, x.time_limit, x.max_iterations, x.observe, x.is_warm, x.warm, x.problem);
}
void fields(auto visit, same_but_const<IpoptReply> auto& x) { visit(x.solution, x.seconds, x.prepare_s, x.iterates); }

}  // namespace zwang
