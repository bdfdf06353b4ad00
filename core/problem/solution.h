#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <zwang/core/problem/types.h>

namespace zwang {

// What a solver claims. The referee (core/referee/measure.h) checks it; the two are recorded side by side.
enum class Status {
  unsolved,                // solve() was never called
  solved,                  // z meets the KKT conditions to the tolerance asked for
  solved_ill_conditioned,  // as solved, but the margins say that z may be far from the true one
  infeasible,              // no z meets the rows; the certificate says why
  iteration_limit,         // z is the last iterate
  time_limit,              // z is the last iterate, or empty when the solver had to be stopped from outside
  unsupported,             // the method does not apply to this problem; the message says why
  bad_input,               // NaN, Inf or M not positive definite; the message says where
  numerical_failure,       // the method broke down and knows it
  crashed,                 // the child process that ran a foreign solver died
};

std::string_view to_string(Status status);  // "solved", "iteration limit", ...

// How close a rank decision was. NaN and -1 where a method makes none.
struct Margins {
  Index rank = -1;                                                      // of the rows the method worked with
  double smallest_accepted = std::numeric_limits<double>::quiet_NaN();  // relative pivot, 1 = orthogonal rows
  double largest_rejected = std::numeric_limits<double>::quiet_NaN();   // relative pivot, 0 = exactly dependent
};

// Resizes a vector of a solution and keeps its storage while the vector is empty. Not shared by copies of the solution.
class Spare {
 public:
  Spare() = default;
  Spare(const Spare&) {}
  Spare& operator=(const Spare&) { return *this; }
  void set_zero(Vector& v, Index size) {
    if ((v.size() == 0) != (size == 0)) v.swap(kept_);
    v.setZero(size);
  }

 private:
  Vector kept_;
};

struct Solution {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  Status status = Status::unsolved;
  Vector z = {};                      // n; empty when the method gives none
  Vector lambda = {};                 // m multipliers, [N] or [N m]; empty when the method gives none
  int iterations = 0;                 // the method's own unit (docs/benchmarking.md lists them)
  Vector certificate = {};            // m, when infeasible: u with u_I >= 0, J'u = 0, c'u > 0 (Farkas)
  std::vector<Index> redundant = {};  // rows that were dropped as consistent combinations of others
  Margins margins = {};
  bool fallback = false;       // a slower, safer path was taken
  std::string handed_to = {};  // the solver that gave this answer in place of the one asked, "" where none did
  double range_gap = unknown;  // |J k - c| / |c|, of nnls_paper
  // Where an accuracy was asked for and a bound was had: |z - z*|_M is at most this times max(|z_u|_M, |z*|_M),
  // rounding aside. Under Coulomb's law z* is here the convex answer of z's own slips.
  double error_bound = unknown;
  std::string message = {};  // the method's own words, for people
  struct {
    Spare z, lambda, certificate;
  } spare = {};

  // Back to unsolved, with the storage kept: a second solve of the same shape then allocates nothing.
  void reset(Index n, Index m) {
    status = Status::unsolved;
    spare.z.set_zero(z, n);
    spare.lambda.set_zero(lambda, m);
    iterations = 0;
    spare.certificate.set_zero(certificate, 0);
    redundant.clear();
    margins = {};
    fallback = false;
    handed_to.clear();
    range_gap = error_bound = unknown;
    message.clear();
  }
  // z.resize(0), lambda.resize(0) and certificate.setZero(m), with the storage kept.
  void empty_z() { spare.z.set_zero(z, 0); }
  void empty_lambda() { spare.lambda.set_zero(lambda, 0); }
  void empty_answer() { empty_z(), empty_lambda(); }
  Vector& zero_certificate(Index m) {
    spare.certificate.set_zero(certificate, m);
    return certificate;
  }
};

// The error in z, relative to the motion, up to which an answer is right where `tolerance` is asked: what `solved`
// says.
inline double accepted_error(double tolerance) { return std::max(10 * tolerance, 1e-12); }

// Solution::error_bound of an answer that is at most `error` from the right one and `step` from z_u, whose length is
// `free`, all in the M-norm. NaN where the motion may be nothing.
inline double relative_bound(double error, double step, double free) {
  const double motion = std::max(free, step - free) - error;
  return error == 0 ? 0 : motion > 0 ? error / motion : std::numeric_limits<double>::quiet_NaN();
}

// The tolerance by which to judge an answer that was asked for at `tolerance`: what is promised is what is claimed.
inline double claimed_tolerance(const Solution& solution, double tolerance) {
  return std::isfinite(solution.error_bound) ? std::max(tolerance, solution.error_bound / 10) : tolerance;
}

}  // namespace zwang
