#include <zwang/bench/timing/sequence.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <zwang/bench/scenes/physical.h>
#include <zwang/core/model/motion.h>
#include <zwang/core/referee/measure.h>

namespace zwang {
namespace {

constexpr double frame_sample_s = 20e-6;
// Of the way to its target that a hand goes in one frame. All of it turned distal phalanges by a radian, through both
// of their limits: 418 of 500 frames were infeasible, and the same.
constexpr double share_per_frame = 1.0 / 16;

// Everybody's target moved as one body by a twist about the palm's target.
std::vector<Pose<double>> moved(const std::vector<Pose<double>>& target, const Vec<double, 6>& twist) {
  std::vector<Pose<double>> out = target;
  const Vec3 center = target[1].position;
  const Mat3 turn = rotation(twist.tail<3>());
  for (Pose<double>& pose : out)
    pose = {center + turn * (pose.position - center) + twist.head<3>(), turn * pose.rotation};
  return out;
}

// Three sines a component pair, of periods that do not meet within the sequence.
Vec<double, 6> wander(int frame) {
  Vec<double, 6> twist;
  for (int k = 0; k < 6; ++k)
    twist[k] = (k < 3 ? 0.01 : 0.1) * std::sin(2 * std::numbers::pi * frame / (90.0 + 37 * k));
  return twist;
}

class Runner {
 public:
  Runner(const Run& run, double share, double time_limit, Dispatcher& desk)
      : run_(run), desk_(desk), left_(share), time_limit_(time_limit) {}

  void frame(const Instance& instance, bool check, const std::atomic<bool>& interrupted) {
    if (left_ <= 0) return;
    SolveRequest call;
    solve(instance, call, check, interrupted, cold_);
    call.warm = std::move(last_);
    last_ = {};
    const SolveReply answer = solve(instance, call, check, interrupted, warm_);
    if (answer.solution.lambda.size() == instance.problem.rows())
      last_ = {instance.problem.key, answer.solution.lambda};
  }
  SequenceTimes times(const std::string& sequence) const {
    return {.sequence = sequence, .solver = run_.solver, .cold = cold_.times(), .warm = warm_.times()};
  }

 private:
  struct Start : SequenceTimes::Start {
    std::vector<double> seconds = {}, steps = {};  // of each frame

    SequenceTimes::Start times() const {
      SequenceTimes::Start all = *this;
      all.frames = std::ssize(seconds);
      all.iterations = median(steps);
      all.solve_s = quartiles(seconds);
      return all;
    }
  };

  SolveReply solve(const Instance& instance, SolveRequest& call, bool check, const std::atomic<bool>& interrupted,
                   Start& into) {
    const Problem& problem = instance.problem;
    call.time_limit = time_limit_;
    call.solves = solves_;
    // Without it the cold solve, which comes first, fills the caches for the warm one: 0.34 where 0.58 is true.
    call.warm_up = last_s_ < 1e-3;
    SolveReply answer = desk_.run(problem, run_, call, &interrupted);
    left_ -= answer.seconds * (solves_ + call.warm_up);
    last_s_ = answer.seconds;
    solves_ = static_cast<int>(std::clamp(frame_sample_s / std::max(answer.seconds, 1e-9), 1.0, 10.0));
    into.seconds.push_back(answer.seconds);
    into.steps.push_back(answer.solution.iterations);
    // The first frame finds no storage yet.
    if (into.seconds.size() > 1) into.allocations = std::max(into.allocations, answer.allocations);
    if (!check) return answer;
    const Metrics m =
        measure(problem, answer.solution, instance.reference ? &*instance.reference : nullptr, run_.tolerance);
    ++into.checked;
    into.right += m.verdict == Verdict::solved || m.verdict == Verdict::infeasible_proven;
    const double error = std::isnan(m.z_error) ? m.z_bound : m.z_error;
    if (!std::isnan(error)) into.worst_z_error = std::max(into.worst_z_error, error);
    return answer;
  }

  const Run& run_;
  Dispatcher& desk_;
  double left_, time_limit_;
  int solves_ = 1;
  double last_s_ = 0;
  WarmStart last_ = {};
  Start cold_ = {{.allocations = 0, .worst_z_error = 0}}, warm_ = cold_;
};

}  // namespace

Sequence hand_sequence(int contacts, int frames) {
  SceneStep posed = drifting_hand(contacts);
  Sequence sequence{"hand of " + std::to_string(contacts) + " contacts", {}};
  AnySolver solver = make_solver("dual_active_set");
  Solution solution;
  const double dt = posed.options.dt;
  Vector z_u;
  for (int f = 0; f < frames; ++f) {
    couple_to_targets(posed.scene, moved(posed.target, wander(f)), share_per_frame * reaching_stiffness(dt), z_u);
    Instance instance = to_instance(posed.scene, z_u, posed.options);
    instance.problem.name = sequence.name + ", frame " + std::to_string(f);
    solver.solve(instance.problem, {}, solution);
    if (solution.z.size() == instance.problem.size()) integrate(posed.scene, solution.z, dt, posed.options.mode);
    sequence.frames.push_back(std::move(instance));
  }
  return sequence;
}

std::vector<SequenceTimes> time_sequence(const Sequence& sequence, std::span<const Run> runs, double budget,
                                         double time_limit, Dispatcher& desk, const std::atomic<bool>& interrupted) {
  std::vector<Runner> runners;
  for (const Run& run : runs) runners.emplace_back(run, budget / static_cast<double>(runs.size()), time_limit, desk);
  for (std::size_t f = 0; f < sequence.frames.size(); ++f) {
    desk.child.load(sequence.frames[f].problem);
    for (Runner& runner : runners) {
      if (interrupted) return {};
      runner.frame(sequence.frames[f], f % Sequence::check_every == 0, interrupted);
    }
  }
  return mapped(runners, [&](const Runner& runner) { return runner.times(sequence.name); });
}

}  // namespace zwang
