#pragma once

#include <zwang/core/problem/islands.h>
#include <zwang/core/problem/shape_cache.h>
#include <zwang/solvers/active_set/joint_space_active_set.h>

namespace zwang {

// Any method on the reduced form of jointed bodies (null_space_form.h), and the way back: what nnls and cholesky do
// with reduce=on. The method solves
//
//   minimize 1/2 |v|^2   subject to  A v >= b,   A = G_I N,  b = h_I - G_I y_E
//
// as a problem of its own, with M = I, z_u = 0 and the keys of its rows. The rows that carry its multipliers then go
// through JointSpaceActiveSet: z and all multipliers recovered, refined against the problem's own M, J, c in
// twice the digits (body_point.h), the rows outside held against them. What that refuses, and what the method does not
// solve in reduced form (an infeasible one among them), the method solves as given: `message` says why and `fallback`
// that it was so.
class NullSpaceAdapter {
 public:
  // One island; plain(problem, options, solution) is the method. `polish`: refine the answer.
  template <class Plain>
  void solve(Plain&& plain, const Problem& problem, const SolveOptions& options, bool polish, Solution& solution) {
    const Deadline deadline(options.time_limit);
    answer_.polish = polish;
    if (prepare(problem, options)) {
      if (reduced_.size() > 0 && reduced_.rows() > 0) plain(reduced_, options, part_);
      if (recover(problem, options, deadline, solution)) return;
    }
    SolveOptions rest = options;
    rest.time_limit = deadline.left();
    plain(problem, rest, solution);
    explain(solution);
  }

 private:
  bool prepare(const Problem& problem, const SolveOptions& options);
  bool recover(const Problem& problem, const SolveOptions& options, const Deadline& deadline, Solution& solution);
  void explain(Solution& solution) const;

  JointSpaceActiveSet answer_;
  Problem reduced_;
  Solution part_;
  std::vector<Index> pushing_;  // rows of reduced_
  std::string_view reason_;
};

// A method as the solver's settings {reduce, polish} ask for it: on the problem as it is, or on its islands, reduced.
template <class Method>
class Reducible {
 public:
  template <class Settings>
  void solve(const Settings& settings, const Problem& problem, const SolveOptions& options, Solution& solution) {
    constexpr Index body = 6;
    plain_.begin();
    reduced_.begin();
    const auto plain = [&](const Problem& p, const SolveOptions& o, Solution& s) {
      plain_.of(p.size(), p.rows()).solve(p, settings, o, s);
    };
    const auto apart = [&](const Problem& p, const SolveOptions& o, Solution& s) {
      reduced_.of(p.size(), JointGraph::kind(p) ^ p.rows()).solve(plain, p, o, settings.polish, s);
    };
    if (!settings.reduce) return plain(problem, options, solution);
    islands_.solve_apart(apart, body, problem, options, solution);
  }

 private:
  Islands islands_;
  ShapeCache<NullSpaceAdapter> reduced_;
  ShapeCache<Method> plain_;
};

}  // namespace zwang
