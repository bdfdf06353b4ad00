#pragma once

#include <algorithm>
#include <concepts>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <zwang/core/problem/problem.h>
#include <zwang/core/problem/solution.h>

namespace zwang {

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
// a backend sees it. What a backend throws becomes a status with one line: Stopped its own, others a numerical failure.
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
