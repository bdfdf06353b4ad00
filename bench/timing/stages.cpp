#include <zwang/bench/timing/stages.h>

#include <array>
#include <limits>

#include <zwang/bench/timing/batch.h>
#include <zwang/solvers/active_set/joint_space_active_set.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

constexpr int samples = 25, repeats = 20;

class Profile {
 public:
  explicit Profile(const Problem& problem) : problem_(&problem) {
    Solution solution;
    solution.reset(problem.size(), problem.rows());
    taken_ = JointSpaceActiveSet().solve(problem, {}, solution);
    for (int up_to = 0; taken_ && up_to < parts; ++up_to) run(up_to);
  }
  void sample() {
    for (int up_to = 0; taken_ && up_to < parts; ++up_to) {
      run(up_to);  // fills the caches
      const double start = thread_cpu_seconds();
      for (int i = 0; i < repeats; ++i) run(up_to);
      seconds_[at(up_to)].push_back((thread_cpu_seconds() - start) / repeats);
    }
  }
  StageTimes times() const {
    if (!taken_) return {};
    // The median of differences, not the difference of medians: the two runs of a sample share its noise.
    const auto part = [&](std::size_t k) {
      std::vector<double> own(seconds_[k]);
      for (std::size_t i = 0; i < own.size(); ++i) own[i] -= seconds_[k - 1][i];
      const double seconds = median(own);
      return seconds > 0 ? seconds : std::numeric_limits<double>::quiet_NaN();
    };
    return {.seconds = {part(4), median(seconds_[0]), part(1), part(2), part(3)}};  // the checks come first, timed last
  }

 private:
  static constexpr int parts = 5;

  void run(int up_to) {
    if (up_to == 0) {
      rows_.build(*problem_);
    } else if (up_to < 3) {
      solution_.reset(problem_->size(), problem_->rows());
      fast_.prepare(*problem_);
      int steps = 0;
      if (up_to == 2) fast_.climb({}, Deadline(), {}, steps);
    } else if (up_to == 3) {
      solution_.reset(problem_->size(), problem_->rows());
      fast_.solve(*problem_, {}, solution_);
    } else {
      whole_.solve(*problem_, {}, solution_);
    }
  }

  const Problem* problem_;
  bool taken_ = false;
  BodyRows rows_;
  JointSpaceActiveSet fast_;
  AnySolver whole_ = make_solver("dual_active_set");
  Solution solution_;
  std::array<std::vector<double>, parts> seconds_;
};

}  // namespace

std::vector<StageTimes> time_stages(const std::vector<Problem>& problems) {
  std::vector<Profile> profiles;
  profiles.reserve(problems.size());
  for (const Problem& p : problems) profiles.emplace_back(p);
  for (int k = 0; k < samples; ++k)
    for (Profile& profile : profiles) profile.sample();
  return mapped(profiles, &Profile::times);
}

}  // namespace zwang
