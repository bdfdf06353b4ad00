#include <zwang/bench/suite/speed.h>

#include <zwang/bench/references/reference.h>
#include <zwang/bench/results/measured_files.h>
#include <zwang/bench/results/records.h>
#include <zwang/bench/results/result.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/bench/timing/neutral_kernel.h>
#include <zwang/bench/timing/sequence.h>
#include <zwang/bench/timing/stages.h>
#include <zwang/core/problem/islands.h>

namespace zwang {
namespace {

constexpr int generated_frames = 500, assembly_samples = 25;

// One scene, assembled over and over while its bodies drift by a micrometre a frame.
struct Assembly {
  explicit Assembly(int contacts) : contacts(contacts), posed(drifting_hand(contacts)) { run(2); }
  void run(int times) {
    for (int i = 0; i < times; ++i) {
      for (Body& body : posed.scene.bodies)
        if (body.motion == Motion::free) body.pose.position.x() += 1e-6;
      assembler.assemble(posed.scene, z_u, posed.options, problem);
    }
  }

  int contacts;
  SceneStep posed;
  Vector z_u = unconstrained(posed);
  Assembler assembler = {};
  Problem problem = {};
  Islands islands = {};
  std::vector<double> assemble_s = {}, islands_s = {};
  long allocations = 0;
};

// All scenes and the neutral kernel in turn, one sample each.
std::vector<std::string> time_assembly() {
  std::vector<Assembly> all;
  for (const int contacts : {0, 4, 16, 64, 200}) all.emplace_back(contacts);
  for (Assembly& a : all) a.islands.split(a.problem);
  std::vector<double> kernel;
  for (int sample = 0; sample < assembly_samples; ++sample) {
    kernel.push_back(neutral_kernel_seconds());
    for (Assembly& a : all) {
      constexpr int times = 20;
      a.run(1);
      const long before = allocations();
      const double start = thread_cpu_seconds();
      a.run(times);
      const double between = thread_cpu_seconds();
      for (int i = 0; i < times; ++i) a.islands.split(a.problem);
      const double end = thread_cpu_seconds();
      a.allocations += allocations() - before;
      a.assemble_s.push_back((between - start) / times);
      a.islands_s.push_back((end - between) / times);
    }
  }
  std::vector<std::string> lines;
  for (const Assembly& a : all) {
    lines.push_back(to_json(AssemblyTimes{.scene = "hand",
                                          .contacts = a.contacts,
                                          .n = a.problem.size(),
                                          .m = a.problem.rows(),
                                          .allocations = a.allocations,
                                          .kernel_s = median(kernel),
                                          .assemble_s = quartiles(a.assemble_s),
                                          .islands_s = quartiles(a.islands_s)}));
  }
  return lines;
}

std::vector<std::string> profile_stages() {
  const std::vector<int> contacts{0, 4, 16, 64, 200};
  std::vector<Problem> hands;
  for (const int c : contacts) hands.push_back(Assembly(c).problem);
  std::vector<StageTimes> times = time_stages(hands);
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < hands.size(); ++k) {
    times[k].scene = "hand";
    times[k].contacts = contacts[k];
    lines.push_back(to_json(times[k]));
  }
  return lines;
}

// False when interrupted.
bool write_sequence(Sequence& sequence, const std::filesystem::path& cache, std::span<const Run> runs, double budget,
                    double time_limit, Dispatcher& desk, const std::atomic<bool>& interrupted, ResultFile& out) {
  for (std::size_t f = 0; f < sequence.frames.size() && !interrupted; f += Sequence::check_every)
    sequence.frames[f].reference = reference_for(sequence.frames[f], cache, {}).reference;
  std::vector<std::string> lines;
  for (const SequenceTimes& t : time_sequence(sequence, runs, budget, time_limit, desk, interrupted))
    lines.push_back(to_json(t));
  if (!interrupted) out.append(lines);
  return !interrupted;
}

}  // namespace

bool write_speed(const std::filesystem::path& directory, const std::filesystem::path& cache, std::span<const Run> runs,
                 double budget, Dispatcher& desk, const std::atomic<bool>& interrupted) {
  ResultFile out(directory / "speed.jsonl", true);
  out.append(time_assembly());
  out.append(profile_stages());

  std::vector<Sequence> sequences;
  for (const int contacts : {16, 64}) {
    sequences.push_back(hand_sequence(contacts, generated_frames));
    sequences.push_back({"seq" + std::to_string(contacts) + " (file)", measured_sequence(contacts)});
  }
  std::erase_if(sequences, [](const Sequence& s) { return s.frames.empty(); });
  for (Sequence& sequence : sequences)
    if (!write_sequence(sequence, cache, runs, budget / static_cast<double>(sequences.size()), 1, desk, interrupted,
                        out))
      return false;
  return true;
}

void write_sequences(const Plan& plan, const std::filesystem::path& directory, const std::filesystem::path& cache,
                     Dispatcher& desk, const std::atomic<bool>& interrupted) {
  ResultFile out(directory / "speed.jsonl", true);
  const std::vector<Run> tightest = plan.tightest_runs();
  std::vector<Sequence> sequences;
  for (const Instance& frame : plan.instances) {
    if (sequences.empty() || sequences.back().name != frame.family) sequences.push_back({frame.family, {}});
    sequences.back().frames.push_back(frame);
  }
  for (Sequence& sequence : sequences)
    if (!write_sequence(sequence, cache, tightest, std::numeric_limits<double>::infinity(), plan.time_limit, desk,
                        interrupted, out))
      return;
}

}  // namespace zwang
