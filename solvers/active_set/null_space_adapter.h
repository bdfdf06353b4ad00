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
  // plain(problem, options, solution) is the method. Islands are reduced and solved apart. `polish`: refine the answer.
  template <class Plain>
  void solve(Plain&& plain, const Problem& problem, const SolveOptions& options, bool polish, Solution& solution);

 private:
  class Reduction {
   public:
    template <class Plain>
    void solve(Plain&& plain, const Problem& problem, const SolveOptions& options, bool polish, Solution& solution);

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

  Islands islands_;
  ShapeCache<Reduction> reductions_;
};

template <class Plain>
void NullSpaceAdapter::solve(Plain&& plain, const Problem& problem, const SolveOptions& options, bool polish,
                             Solution& solution) {
  constexpr Index body = 6;
  reductions_.begin();
  const auto apart = [&](const Problem& p, const SolveOptions& o, Solution& s) {
    reductions_.of(p.size(), JointGraph::kind(p) ^ p.rows()).solve(plain, p, o, polish, s);
  };
  islands_.solve_apart(apart, body, problem, options, solution);
}

template <class Plain>
void NullSpaceAdapter::Reduction::solve(Plain&& plain, const Problem& problem, const SolveOptions& options, bool polish,
                                        Solution& solution) {
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

}  // namespace zwang
