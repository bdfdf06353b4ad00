#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <random>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/referee/measure.h>
#include <zwang/core/referee/scaled_problem.h>
#include <zwang/solvers/registry.h>
#include "tests/recorded_data.h"

namespace zwang {
namespace {

std::filesystem::path problems_folder() { return test::recorded_data() / "problems"; }

// What the referee says without the reference, against what it says with it.
struct Tally {
  int answers = 0, right = 0, right_decided = 0, wrong = 0, wrong_decided = 0;
  std::vector<std::string> lies = {};

  void look(const Instance& instance, const Solution& s, const std::string& who) {
    const Reference& truth = *instance.reference;
    constexpr double tolerance = 1e-14;
    const Metrics known = measure(instance.problem, s, &truth, tolerance);
    const Metrics blind = measure(instance.problem, s, nullptr, tolerance);
    ++answers;
    const bool is_right = known.verdict == Verdict::solved;
    (is_right ? right : wrong)++;
    right_decided += is_right && blind.verdict == Verdict::solved;
    wrong_decided += !is_right && (blind.verdict == known.verdict);
    const bool lie = !is_right && blind.verdict == Verdict::solved;
    const bool slander = known.verdict != Verdict::wrong && blind.verdict == Verdict::wrong;
    const bool too_low = truth.feasible && known.z_error > blind.z_bound * (1 + 1e-9) + 2e-16;
    if (lie || slander || too_low) lies.push_back(instance.problem.name + " by " + who);
  }
};

// Every answer of the native solvers, the true z, and the true z off by 1e-15 to 1e-3.
Tally look_through(const std::string& file, std::size_t step) {
  Tally tally;
  std::mt19937_64 random(1);
  const std::vector<Instance> instances = read_problems(problems_folder() / file);
  for (std::size_t k = 0; k < instances.size(); k += step) {
    const Instance& instance = instances[k];
    if (!instance.reference) continue;
    const Reference& truth = *instance.reference;
    const Problem& p = instance.problem;
    if (truth.feasible && truth.z.size() != p.size()) continue;
    const Vector z = truth.feasible ? truth.z : p.z_u;
    const double size = std::max(z.cwiseAbs().maxCoeff(), p.z_u.cwiseAbs().maxCoeff());
    for (const double error : {0.0, 1e-15, 1e-12, 1e-9, 1e-3}) {
      Solution s{.status = Status::solved, .z = z};
      for (double& x : s.z) x += error * size * std::normal_distribution<>()(random);
      tally.look(instance, s, "perturbation");
    }
    for (const SolverEntry& entry : solvers()) {
      if (entry.foreign) continue;
      SolveOptions options{.tolerance = 1e-12, .max_iterations = 2000};
      const Solution s = entry.make("").solve(p, options);
      if (s.status == Status::solved || s.status == Status::solved_ill_conditioned ||
          s.status == Status::iteration_limit)
        tally.look(instance, s, entry.name);
    }
  }
  std::cout << file << ": " << tally.answers << " answers, " << tally.right << " right (" << tally.right_decided
            << " put at solved), " << tally.wrong << " not (" << tally.wrong_decided << " put where the truth does)\n";
  return tally;
}

struct File {
  const char* name;
  std::size_t step;  // every step-th problem
};

class Withheld : public testing::TestWithParam<File> {};

TEST_P(Withheld, NoWrongZIsPutAtSolvedAndMostRightOnesAre) {
  if (!std::filesystem::exists(problems_folder() / GetParam().name))
    GTEST_SKIP() << "real data not found: " << problems_folder() / GetParam().name;
  const Tally tally = look_through(GetParam().name, GetParam().step);
  EXPECT_TRUE(tally.lies.empty()) << tally.lies.size() << " false, first: " << tally.lies.front();
  EXPECT_GT(tally.answers, 0);
  EXPECT_GE(tally.right_decided, 0.95 * tally.right);
}

INSTANTIATE_TEST_SUITE_P(Data, Withheld,
                         testing::Values(File{"atlas.h5", 1}, File{"H0.h5", 5}, File{"H16.h5", 5}, File{"H64.h5", 5},
                                         File{"H200.h5", 5}, File{"dup3_H64.h5", 1}, File{"tight_feas.h5", 1},
                                         File{"nearpar1e-10.h5", 1}, File{"nearpar1e-6.h5", 1}, File{"stress.h5", 15}),
                         [](const auto& info) {
                           std::string name = std::filesystem::path(info.param.name).stem().string();
                           std::replace_if(name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
                           return name;
                         });

}  // namespace
}  // namespace zwang
