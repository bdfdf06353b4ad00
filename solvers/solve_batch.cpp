#include <zwang/solvers/solve_batch.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <stdexcept>
#include <string>
#include <thread>

namespace zwang {

BatchSolver::BatchSolver(const AnySolver& solver, int threads) {
  if (threads < 0) throw std::invalid_argument("a batch on " + std::to_string(threads) + " threads");
  const unsigned count =
      threads > 0 ? static_cast<unsigned>(threads) : std::max(1u, std::thread::hardware_concurrency());
  solvers_.assign(count, solver);
}

void BatchSolver::solve(std::span<const Problem> problems, const SolveOptions& options, std::span<Solution> solutions) {
  if (problems.size() != solutions.size())
    throw std::invalid_argument("a batch of " + std::to_string(problems.size()) + " problems and " +
                                std::to_string(solutions.size()) + " solutions");
  if (options.observe) throw std::invalid_argument("a batch has no observer: several threads would call it");

  std::atomic<std::size_t> next = 0;
  std::vector<std::exception_ptr> failures(problems.size());
  const auto work = [&](std::size_t thread) {
    for (std::size_t k = next++; k < problems.size(); k = next++) {
      try {
        solvers_[thread].solve(problems[k], options, solutions[k]);
      } catch (...) {
        failures[k] = std::current_exception();
      }
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t t = 1; t < std::min(solvers_.size(), problems.size()); ++t) others.emplace_back(work, t);
    work(0);
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace zwang
