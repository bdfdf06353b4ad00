// A second solve of the same shape allocates nothing, whatever the answer is: on every scene there is, and where the
// stability families are infeasible, need the slower path or are beyond what a method can do.
#include <gtest/gtest.h>

#include <algorithm>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/solvers/linalg/library_memory.h>
#include <zwang/solvers/registry.h>

#include "tests/parameter_name.h"

namespace zwang {
namespace {

// Before the first solver: a program that counts allocations asks for SuiteSparse's to be kept.
[[maybe_unused]] const bool keeps_library_memory = (LibraryMemory::install(), true);

std::vector<Instance> all_scenes() {
  std::vector<Instance> all;
  const auto add = [&](const std::string& spec) { std::ranges::move(make_scenes(spec), std::back_inserter(all)); };
  for (const SceneEntry& scene : scenes()) add(scene.name);
  for (const char* family : {"MR", "MRC", "NPE", "LOOP", "GAP", "INC", "WEAK", "NPI", "WED"})
    add(std::string(family).append("(k=20,33,39,45)"));
  add("hands(hands=8)");
  add("hand(contacts=100,limits=20,feasible=0,drift=0.0078125,seed=1..20)");
  add("hand(limits=20,drift=0,locked=1)");
  return all;
}

class SecondSolve : public testing::TestWithParam<std::string> {};

TEST_P(SecondSolve, AllocatesNothingWhateverTheAnswerIs) {
  static const std::vector<Instance> instances = all_scenes();
  const SolveOptions options{.max_iterations = 2000};
  int infeasible = 0;
  for (const Instance& instance : instances) {
    const Problem& p = instance.problem;
    AnySolver solver = make_solver(GetParam());
    if (!solver.supports(p).empty()) continue;
    Solution s;
    solver.solve(p, options, s);
    const long before = allocations();
    solver.solve(p, options, s);
    solver.solve(p, options, s);
    EXPECT_EQ(allocations() - before, 0) << p.name << ": " << to_string(s.status) << ", " << s.message;
    infeasible += s.status == Status::infeasible;
  }
  RecordProperty("infeasible", infeasible);
  const SolverEntry& entry = *find_solver(GetParam());
  EXPECT_GE(infeasible, entry.exact && entry.sees_infeasibility ? 10 : 0);
}

std::vector<std::string> native() {
  std::vector<std::string> names = {"nnls:reduce=on", "cholesky:reduce=on"};
  for (const SolverEntry& entry : solvers())
    // A few rounds of a fixed point do all that many do.
    if (!entry.foreign) names.push_back(entry.name == "fixed_point" ? "fixed_point:max_rounds=5" : entry.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Native, SecondSolve, testing::ValuesIn(native()),
                         [](const auto& info) { return test::parameter_name(info.param); });

}  // namespace
}  // namespace zwang
