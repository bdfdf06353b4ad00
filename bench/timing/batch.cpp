#include <zwang/bench/timing/batch.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include <zwang/bench/timing/neutral_kernel.h>
#include <zwang/core/problem/islands.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

constexpr double sample_s = 50e-6;  // a reading of the thread's clock costs 0.3 us
// Longer solves do without an untimed one before them: other solvers have emptied the caches, which is a percent of
// such a solve. With 1 ms here, 64 hands (1.3 ms, 1.4 MB) paid 8 % where 32 paid nothing, and time seemed to grow
// faster.
constexpr double warmed_s = 10e-3;

int solves_per_sample(double seconds) {
  return static_cast<int>(std::clamp(std::ceil(sample_s / std::max(seconds, 1e-9)), 1.0, 1000.0));
}

bool has_answer(const Timed& t) {
  using enum Status;
  const Status s = t.solution.status;
  return s == solved || s == solved_ill_conditioned || s == infeasible || s == iteration_limit;
}

std::string too_large(const Problem& problem, const Run& run) {
  if (problem.size() <= run.largest_island) return {};
  Islands islands;
  islands.split(problem);
  for (const Island& island : islands.all())
    if (island.problem.size() > run.largest_island)
      return "not run: dense, and one island has " + std::to_string(island.problem.size()) + " unknowns";
  return {};
}

}  // namespace

SolveReply Dispatcher::run(const Problem& problem, const Run& run, SolveRequest call,
                           const std::atomic<bool>* interrupted) {
  call.solver = run.solver;
  call.tolerance = run.tolerance;
  call.accuracy = run.accuracy;
  return run.foreign ? child.run(call, interrupted) : here.run(problem, call);
}

std::vector<int> share_budget(std::span<const double> seconds, double budget, int most) {
  const auto affordable = [&](double s, double share) {
    return static_cast<int>(std::min(std::floor(share / std::max(s, 1e-9)), static_cast<double>(most)));
  };
  double low = 0, high = std::max(budget, 0.0);
  for (int i = 0; i < 50; ++i) {
    const double share = (low + high) / 2;
    double sum = 0;
    for (const double s : seconds) sum += s * affordable(s, share);
    (sum <= budget ? low : high) = share;
  }
  return mapped(seconds, [&](double s) { return affordable(s, low); });
}

std::vector<Timed> time_batch(const Problem& problem, std::span<const Run> runs, const BatchLimits& limits,
                              Dispatcher& desk, const std::atomic<bool>& interrupted, const BatchProgress& progress,
                              std::vector<double>* kernel) {
  std::vector<Timed> timed(runs.size());
  std::vector<SolveRequest> calls(runs.size());                 // of one sample
  std::vector<double> seconds(runs.size(), limits.budget + 1);  // that it costs; too dear to repeat, until known
  std::map<std::string, double> gave_up;                        // solver -> tolerance
  desk.child.load(problem);

  // First solves, and a warm-up where repetitions will follow.
  for (std::size_t i = 0; i < runs.size(); ++i) {
    progress(0.5 * static_cast<double>(i) / static_cast<double>(runs.size()), i);
    if (interrupted) return {};
    Timed& t = timed[i];
    if (const auto tired = gave_up.find(runs[i].solver); tired != gave_up.end()) {
      t.solution.status = Status::time_limit;
      t.solution.message = printed("not run: met the time limit at tolerance %g", tired->second);
      continue;
    }
    if (std::string reason = too_large(problem, runs[i]); !reason.empty()) {
      t.solution.status = Status::unsupported;
      t.solution.message = std::move(reason);
      continue;
    }
    SolveRequest& call = calls[i];
    call.time_limit = std::max(limits.time_limit, runs[i].least_time_limit);
    call.fresh = true;
    SolveReply first = desk.run(problem, runs[i], call, &interrupted);
    call.fresh = false;
    t.solution = std::move(first.solution);
    t.first_s = first.seconds;
    t.first_prepare_s = first.prepare_s;
    if (t.solution.status == Status::time_limit) gave_up[runs[i].solver] = runs[i].tolerance;
    if (!limits.repeat || !has_answer(t) || (limits.repetitions == 0 && t.first_s > limits.budget)) continue;
    const SolveReply warm = desk.run(problem, runs[i], call, &interrupted);
    const double again = warm.seconds;
    t.allocations = warm.allocations;
    call.solves = solves_per_sample(again);
    call.warm_up = again < warmed_s;
    seconds[i] = again * (call.solves + call.warm_up);
  }

  if (!limits.repeat) return timed;

  // Repetitions.
  std::vector<int> counts = share_budget(seconds, limits.budget, BatchLimits::most);
  std::vector<std::size_t> order;  // whose turn it is; runs.size(): the neutral kernel
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (limits.repetitions > 0) counts[i] = has_answer(timed[i]) ? limits.repetitions : 0;
    order.insert(order.end(), at(counts[i]), i);
  }
  const auto samples = static_cast<double>(order.size());
  if (kernel)
    order.insert(order.end(), at(limits.repetitions > 0 ? limits.repetitions : BatchLimits::most), runs.size());
  std::shuffle(order.begin(), order.end(), std::mt19937_64());
  double done = 0;
  for (const std::size_t i : order) {
    if (interrupted) return {};
    if (i == runs.size()) {
      kernel->push_back(neutral_kernel_seconds());
      continue;
    }
    progress(0.5 + 0.5 * done++ / samples, i);
    const SolveReply answer = desk.run(problem, runs[i], calls[i], &interrupted);
    if (answer.solution.status != timed[i].solution.status) continue;
    timed[i].samples.push_back(answer.seconds);
    timed[i].prepare_s.push_back(answer.prepare_s);
  }
  return interrupted ? std::vector<Timed>() : timed;
}

}  // namespace zwang
