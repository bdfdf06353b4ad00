#pragma once

#include <vector>

#include <zwang/solvers/active_set/lawson_hanson.h>
#include <zwang/solvers/form/warm_rows.h>
#include <zwang/solvers/form/whiten.h>
#include <zwang/solvers/linalg/dense_storage.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// The method of the generalized god-object paper, Eq. 6-11:
//
//   M = Q'Q (6),  J k = c (7),  s = Q (k - z_u) (8),  J_Q = J Q^-1 (9),
//   lambda = argmin |J_Q' lambda - s|^2, lambda_I >= 0 (10),   z = Q^-1 J_Q' lambda + z_u (11).
//
// Mended: the 1/2 that Eq. 10 prints inside the norm (it doubles lambda, and Eq. 11 then returns z_u + 2 (z - z_u)),
// and lambda is free on equality rows (a joint must be able to pull).
//
// Kept, to show where the published method fails: k exists only where c lies in range(J). Elsewhere k is the
// least-squares solution, so the method silently solves the problem with J k in place of c, and claims success. An
// infeasible problem looks the same. Solution::range_gap says how far off that is: |J k - c| / |c|, in the rows' own
// units (0 for c = 0, where k = 0 serves).
// Where k exists the method is right.
struct NnlsPaper {
  static constexpr const char* name = "nnls_paper";
  double rank_threshold = 1e-12;  // relative pivot of a column of J_Q

  static std::vector<Setting<NnlsPaper>> settings() {
    return {{"rank_threshold", &NnlsPaper::rank_threshold, "relative pivot below which a column of J_Q is dependent"}};
  }

  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

 private:
  double find_s(const Problem& problem, const Deadline& deadline, Solution& solution);

  DenseStorage storage_;
  Whitened rows_;
  WarmRows warm_rows_;
  LawsonHanson least_squares_;
  ThinQr columns_;             // of J_Q
  std::vector<Index> column_;  // of J_Q, in the order of columns_
  Matrix Gt_, J_Q_;
  Vector b_, length_, remaining_, rest_, part_, s_, y_;
};

}  // namespace zwang
