#include "bench/suite/stages.h"

#include <algorithm>
#include <array>

#include "bench/suite/batch.h"
#include "solvers/reduced_active_set.h"
#include "solvers/registry.h"

namespace zwang {
namespace {

constexpr int samples = 25, repeats = 20;

class Profile {
 public:
  explicit Profile(const Problem& problem) : problem_(&problem) {
    Solution solution;
    solution.reset(problem.size(), problem.rows());
    taken_ = ReducedActiveSet().solve(problem, {}, solution);
    for (int up_to = 0; taken_ && up_to < parts; ++up_to) run(up_to);
  }
  void sample() {
    for (int up_to = 0; taken_ && up_to < parts; ++up_to) {
      run(up_to);  // fills the caches
      const double start = thread_cpu_seconds();
      for (int i = 0; i < repeats; ++i) run(up_to);
      seconds_[static_cast<std::size_t>(up_to)].push_back((thread_cpu_seconds() - start) / repeats);
    }
  }
  StageTimes times() const {
    if (!taken_) return {};
    std::array<double, parts> until;
    for (std::size_t k = 0; k < parts; ++k) until[k] = quartiles(seconds_[k]).median;
    return {.whiten = until[0],
            .joints = until[1] - until[0],
            .rows = until[2] - until[1],
            .climb = until[3] - until[2],
            .refine = until[4] - until[3],
            .checks = until[5] - until[4]};
  }

 private:
  static constexpr int parts = 6;

  void fill() {
    const auto& inequalities = form_.inequalities();
    climb_.reset(form_.freedom(), static_cast<Index>(inequalities.size()));
    climb_.fixed_length = form_.y_E().norm();
    for (const Index i : inequalities) {
      const BodyRows& rows = form_.rows();
      form_.reduce_row(i, climb_.admit(rows.h[i] - rows.dot(i, form_.y_E()), rows.magnitude[i]));
    }
  }

  void run(int up_to) {
    if (up_to == 0) {
      rows_.build(*problem_);
    } else if (up_to < 4) {
      form_.build(*problem_);
      form_.form_basis();
      if (up_to >= 2) fill();
      int steps = 0;
      if (up_to == 3) climb_.climb(steps, SolveOptions{}.max_iterations, Deadline(1));
    } else if (up_to == 4) {
      solution_.reset(problem_->size(), problem_->rows());
      fast_.solve(*problem_, {}, solution_);
    } else {
      whole_.solve(*problem_, {}, solution_);
    }
  }

  const Problem* problem_;
  bool taken_ = false;
  BodyRows rows_;
  ReducedForm form_;
  LeastDistance climb_;
  ReducedActiveSet fast_;
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
  std::vector<StageTimes> all;
  for (const Profile& profile : profiles) all.push_back(profile.times());
  return all;
}

}  // namespace zwang
