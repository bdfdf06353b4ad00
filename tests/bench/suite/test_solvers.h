#pragma once

#include <unistd.h>

#include <Eigen/Dense>
#include <atomic>
#include <csignal>
#include <vector>

#include <zwang/core/problem/instance.h>
#include <zwang/solvers/registry.h>

// Solvers that exist in tests alone: one that is right wherever every row is an active equality, and the misbehaviours
// that a child process is there for.
namespace zwang::tests {

// z of the problem with every row as an equality, from the KKT system.
struct AllActive {
  static constexpr std::string_view name = "all_active";
  void solve(const Problem& p, const SolveOptions& options, Solution& out) {
    const Index n = p.size(), m = p.rows();
    out.reset(n, m);
    Matrix K = Matrix::Zero(n + m, n + m);
    K.topLeftCorner(n, n) = p.M;
    K.bottomLeftCorner(m, n) = p.J;
    K.topRightCorner(n, m) = -Matrix(p.J).transpose();
    Vector right(n + m);
    right << p.M * p.z_u, p.c;
    const Vector x = K.completeOrthogonalDecomposition().solve(right);
    out.z = x.head(n);
    out.lambda = x.tail(m);
    for (out.iterations = 1; out.iterations < 5 && out.iterations < options.max_iterations; ++out.iterations)
      if (options.observe) options.observe(out.iterations, out.z / (6 - out.iterations), out.lambda);
    out.status = Status::solved;
  }
};

struct Hangs {
  static constexpr std::string_view name = "hangs";
  void solve(const Problem&, const SolveOptions&, Solution&) {
    for (volatile bool forever = true; forever;) {
    }
  }
};

struct Sleeps {
  static constexpr std::string_view name = "sleeps";
  void solve(const Problem&, const SolveOptions&, Solution&) {
    for (;;) pause();
  }
};

struct Aborts {
  static constexpr std::string_view name = "aborts";
  void solve(const Problem&, const SolveOptions&, Solution&) {
    std::signal(SIGABRT, SIG_DFL);
    std::abort();
  }
};

struct Throws {
  static constexpr std::string_view name = "throws";
  void solve(const Problem&, const SolveOptions&, Solution&) { throw std::runtime_error("no memory for this"); }
};

// Says solved of z_u.
struct Lies {
  static constexpr std::string_view name = "lies";
  void solve(const Problem& p, const SolveOptions&, Solution& out) {
    out.reset(p.size(), p.rows());
    out.z = p.z_u;
    out.status = Status::solved;
  }
};

template <class S>
SolverEntry entry(bool foreign) {
  SolverEntry e;
  e.name = S::name;
  e.method = "for tests";
  e.foreign = foreign;
  e.make = [](std::string_view) { return AnySolver(S{}); };
  return e;
}

// m rows of a chain of n unit masses, each held to its neighbour, the last one pushed: all rows are active.
inline Instance chain(Index n) {
  Instance instance;
  Problem& p = instance.problem;
  p.name = "chain(n=" + std::to_string(n) + ")";
  p.M.resize(n, n);
  p.M.setIdentity();
  p.z_u = Vector::LinSpaced(n, 1, 2);
  p.J.resize(n - 1, n);
  for (Index i = 0; i + 1 < n; ++i) {
    p.J.insert(i, i) = 1;
    p.J.insert(i, i + 1) = -1;
    p.key.push_back({1, static_cast<std::uint32_t>(i)});
    instance.origin.push_back({"rod", std::to_string(i)});
  }
  p.J.makeCompressed();
  p.c = Vector::Zero(n - 1);
  p.kind.assign(static_cast<std::size_t>(n - 1), RowKind::equality);
  instance.family = "chain";
  instance.knob = "n";
  instance.knob_value = static_cast<double>(n);
  // All move alike: z = mean(z_u).
  instance.reference = Reference{.z = Vector::Constant(n, 1.5), .bound = 1e-15, .method = "closed form"};
  return instance;
}

inline const std::vector<SolverEntry> all = {entry<AllActive>(false), entry<Lies>(false), entry<Aborts>(true),
                                             entry<Hangs>(true)};
inline const std::atomic<bool> never = false;  // interrupted

}  // namespace zwang::tests
