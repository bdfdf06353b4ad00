#include <zwang/bench/suite/flow.h>

#include <algorithm>
#include <iterator>

namespace zwang {
namespace {

// The problem as recorded answers are judged: where it brings no truth, the answer of the run that is proven nearest to
// it stands for it.
Instance with_proven_answer(Instance instance, const std::vector<Cell>& cells) {
  if (instance.reference || instance.problem.has_tangents()) return instance;
  const Cell* nearest = nullptr;
  for (const Cell& cell : cells)
    if (cell.result.metrics.verdict == Verdict::solved &&
        (!nearest || cell.result.metrics.z_bound < nearest->result.metrics.z_bound))
      nearest = &cell;
  if (nearest)
    instance.reference = Reference{.z = nearest->timed.solution.z,
                                   .bound = nearest->result.metrics.z_bound,
                                   .method = "proven answer of " + nearest->result.solver};
  return instance;
}

// The row of results that a run leaves: `r` from describe(), the referee's findings, the times.
Result to_result(Result r, const Instance& instance, const Run& run, const Timed& timed) {
  r.solver = run.solver;
  r.foreign = run.foreign;
  r.tolerance = run.tolerance;
  r.accuracy = run.accuracy;
  judge(r, instance, timed.solution);
  r.repetitions = static_cast<int>(timed.samples.size());
  const double prepare_s = timed.prepare_s.empty() ? timed.first_prepare_s : quartiles(timed.prepare_s).median;
  if (prepare_s > 0) r.prepare_s = prepare_s;
  if (!timed.samples.empty()) {
    const Quartiles q = quartiles(timed.samples);
    r.solve_s = q.median;
    r.solve_s_q1 = q.q1;
    r.solve_s_q3 = q.q3;
    r.setup_s = std::max(0.0, timed.first_s - q.median);
    r.allocations = timed.allocations;
  } else if (timed.first_s > 0) {
    r.solve_s = r.solve_s_q1 = r.solve_s_q3 = timed.first_s;
    r.repetitions = 1;
  }
  return r;
}

}  // namespace

bool run_flow(const Flow& flow, Dispatcher& dispatcher, const std::atomic<bool>& interrupted) {
  const Instance instance = flow.assemble();
  std::vector<double> kernel;
  std::vector<Timed> solved =
      time_batch(instance.problem, flow.runs, flow.limits, dispatcher, interrupted, flow.progress, &kernel);
  if (solved.empty()) return false;

  const double kernel_s = median(std::move(kernel));
  const auto described = [&](const Instance& of) {
    Result problem = describe(of);
    problem.kernel_s = kernel_s;
    return problem;
  };
  const Result problem = described(instance);
  std::vector<Cell> cells, recorded;
  for (std::size_t i = 0; i < solved.size(); ++i) {
    Result measured = to_result(problem, instance, flow.runs[i], solved[i]);
    cells.push_back({std::move(measured), std::move(solved[i])});
  }
  if (flow.recorded_tolerance > 0 && !instance.recorded.empty()) {
    const Instance judged = with_proven_answer(instance, cells);
    for (const RecordedAnswer& answer : judged.recorded)
      recorded.push_back({judge_recorded(described(judged), judged, answer, flow.recorded_tolerance)});
  }
  cells.insert(cells.begin(), std::make_move_iterator(recorded.begin()), std::make_move_iterator(recorded.end()));
  flow.append(instance, cells);
  return true;
}

}  // namespace zwang
