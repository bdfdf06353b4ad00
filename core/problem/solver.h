#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <zwang/core/problem/problem.h>

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
  Vector& zero_certificate(Index m) {
    spare.certificate.set_zero(certificate, m);
    return certificate;
  }
};

// Multipliers of an earlier frame, matched by key: rows that vanished are dropped, new rows start inactive.
struct WarmStart {
  std::vector<RowKey> key = {};
  Vector lambda = {};
};

// Called once per iterate; timed runs leave it empty. lambda may be empty.
using Observer = std::function<void(int iteration, const Vector& z, const Vector& lambda)>;

class NullSpaceForm;
class Prover;

struct SolveOptions {
  double tolerance = 1e-10;  // relative, in the M-norm on unit rows
  // Where one is above 0, a method ends, solved, as soon as a bound on its error proves that much (error_bound), and
  // goes on to the tolerance where there is no bound: relative to the motion, in the M-norm; the speed of any body, in
  // z's unit.
  double accuracy = 0, speed_accuracy = 0;
  int max_iterations = 1000000;  // a hard stop in the method's own unit; the last iterate is returned
  double time_limit = std::numeric_limits<double>::infinity();    // seconds
  double memory_limit = std::numeric_limits<double>::infinity();  // bytes of dense parts, where the machine has more
  const WarmStart* warm_start = nullptr;
  Observer observe = nullptr;
  Prover* prover = nullptr;       // of bounds, where there is an accuracy (solvers/prover.h): the registry's
  NullSpaceForm* form = nullptr;  // gets what the method made of jointed bodies, for who differentiates the answer

  bool has_accuracy() const { return accuracy > 0 || speed_accuracy > 0; }
  // "1e-4", "1e-4m/s" or "": none. Throws std::invalid_argument.
  void read_accuracy(std::string_view text);
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

// Thrown by a solver that met a limit before there was an iterate to show. AnySolver makes a status of it.
struct Stopped {
  Status status;
  std::string message;
};

// A solver is the struct of its settings and its workspace. solve() writes into the caller's solution; a second solve
// of the same shape allocates nothing (native solvers) and gives the same bits. Numerical trouble is a status, never
// an exception; Stopped and std::bad_alloc are for what does not fit into the time or the memory there is. Optional
// members: `std::string supports(const Problem&) const` ("" or the reason why not), `static std::vector<Setting<S>>
// settings()` for the command line, and `static constexpr std::array laws{Law::convex, Law::coulomb}` of a solver that
// reads tangent rows under these laws. Without it a solver never sees a tangent row.
template <class S>
concept Solver = std::copyable<S> && requires(S s, const Problem& p, const SolveOptions& o, Solution& out) {
  { S::name } -> std::convertible_to<std::string_view>;
  { s.solve(p, o, out) } -> std::same_as<void>;
};

// Does S read tangent rows under this law?
template <class S>
constexpr bool reads(Law law) {
  if constexpr (requires { S::laws; })
    return std::ranges::find(S::laws, law) != std::ranges::end(S::laws);
  else
    return false;
}

// Any solver by value. Sizes are required to match (throws), and NaN or Inf is met with Status::bad_input here, before
// a backend sees it. Stopped and std::bad_alloc become a status with one line; what else a backend throws is passed on.
// After an exception the workspace is built anew.
class AnySolver {
 public:
  template <class S>
    requires(!std::same_as<S, AnySolver> && Solver<S>)
  AnySolver(S s) : method_(std::make_unique<MethodOf<S>>(std::move(s))) {}
  AnySolver(const AnySolver& other) : method_(other.method_->clone()) {}
  AnySolver(AnySolver&&) = default;
  AnySolver& operator=(AnySolver other) {
    method_ = std::move(other.method_);
    return *this;
  }

  std::string_view name() const { return method_->name(); }
  std::string supports(const Problem& problem) const { return method_->supports(problem); }
  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);
  Solution solve(const Problem& problem, const SolveOptions& options = {});

 private:
  static std::string cannot_read(Law law);  // the sentence

  struct Method {
    virtual ~Method() = default;
    virtual std::unique_ptr<Method> clone() const = 0;
    virtual std::string_view name() const = 0;
    virtual std::string supports(const Problem& problem) const = 0;
    virtual void solve(const Problem& problem, const SolveOptions& options, Solution& solution) = 0;
  };

  template <class S>
  struct MethodOf final : Method {
    explicit MethodOf(S s) : settings(std::move(s)), solver(std::make_unique<S>(settings)) {}
    MethodOf(const MethodOf& other) : settings(other.settings), solver(std::make_unique<S>(*other.solver)) {}
    std::unique_ptr<Method> clone() const override { return std::make_unique<MethodOf>(*this); }
    std::string_view name() const override { return S::name; }
    std::string supports(const Problem& problem) const override {
      if (problem.has_tangents() && !reads<S>(problem.law)) return cannot_read(problem.law);
      if constexpr (requires {
                      { settings.supports(problem) } -> std::same_as<std::string>;
                    })
        return settings.supports(problem);
      else
        return {};
    }
    void solve(const Problem& problem, const SolveOptions& options, Solution& solution) override {
      if (problem.has_tangents() && !reads<S>(problem.law))
        throw Stopped{Status::unsupported, cannot_read(problem.law)};
      try {
        solver->solve(problem, options, solution);
      } catch (...) {
        solver = std::make_unique<S>(settings);
        throw;
      }
    }

    S settings;  // with a workspace that was never used
    std::unique_ptr<S> solver;
  };

  std::unique_ptr<Method> method_;
};

}  // namespace zwang
