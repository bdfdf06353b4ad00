#include <gtest/gtest.h>
#include <sys/resource.h>
#include <filesystem>
#include <fstream>
#include <new>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/timing/child.h>
#include <zwang/core/problem/cpu_clock.h>
#include <zwang/core/problem/memory.h>
#include <zwang/solvers/registry.h>
#include "tests/folders.h"

namespace zwang {
namespace {

Problem random_problem(const char* scene) { return make_scenes(scene).at(0).problem; }

class Limits : public testing::TestWithParam<const char*> {};

TEST_P(Limits, DensePartsThatDoNotFitAreRefusedWithTheirSize) {
  const Problem problem = random_problem("random(n=120,m=160)");
  AnySolver solver = make_solver(GetParam());
  SolveOptions options;
  options.memory_limit = 8000;
  options.max_iterations = 2000;
  const Solution refused = solver.solve(problem, options);
  EXPECT_EQ(refused.status, Status::numerical_failure);
  EXPECT_NE(refused.message.find("dense parts take"), std::string::npos) << refused.message;
  EXPECT_EQ(refused.z.size(), 0);

  // The same object, with room, does as a new one does.
  options.memory_limit = SolveOptions().memory_limit;
  const Solution again = solver.solve(problem, options), fresh = make_solver(GetParam()).solve(problem, options);
  EXPECT_EQ(again.status, fresh.status);
  EXPECT_EQ(again.z, fresh.z);
}

// A solve of this size takes the slowest of them minutes; what is left after the deadline is one step of a loop: 0.01
// s, 0.04 s with sanitizers. Whoever is done before its deadline may say so.
TEST_P(Limits, PreparationsEndAtTheDeadline) {
  const Problem problem = random_problem("random(n=1200,m=1800)");
  SolveOptions options;
  for (const double limit : {0.0, 0.02, 0.1}) {
    options.time_limit = limit;
    AnySolver solver = make_solver(GetParam());
    const double start = thread_cpu_seconds();
    const Solution stopped = solver.solve(problem, options);
    const double used = thread_cpu_seconds() - start;
    const bool done_before = limit > 0 && stopped.status == Status::solved;
    EXPECT_TRUE(done_before || stopped.status == Status::time_limit) << limit << " s: " << stopped.message;
    EXPECT_LE(used, limit + 0.3);
    EXPECT_TRUE(stopped.z.size() == problem.size() || !stopped.message.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, Limits,
                         testing::Values("dual_active_set", "nnls", "nnls_paper", "cholesky", "newton", "pgs", "apgd",
                                         "projected_gradient"),
                         [](const auto& info) { return std::string(info.param); });

struct Hungry {
  static constexpr std::string_view name = "hungry";
  void solve(const Problem&, const SolveOptions&, Solution&) { throw std::bad_alloc(); }
};

TEST(Memory, RefusedAllocationsAreOneLineHereAndInAChild) {
  const Problem problem = random_problem("random(n=6,m=8)");
  const MakeSolver make = [](std::string_view) { return AnySolver(Hungry()); };
  SolveRequest call;
  call.solver = "hungry";
  Child child(make);
  child.load(problem);
  for (const SolveReply& answer : {SolveService(make).run(problem, call), child.run(call)}) {
    EXPECT_EQ(answer.solution.status, Status::numerical_failure);
    EXPECT_EQ(answer.solution.message, "out of memory");
  }
}

// In a container whose files fill the memory it may use, what they fill is free: the kernel gives it up when asked.
TEST(Memory, FilesKeptByAControlGroupAreFree) {
  const auto folder = own_path("group");
  const auto put = [&](const char* file, const char* text) {
    std::filesystem::create_directories((folder / file).parent_path());
    std::ofstream(folder / file) << text;
  };
  put("memory.max", "1000000\n");
  put("memory.current", "990000\n");
  put("memory.stat", "anon 90000\nactive_file 300000\ninactive_file 600000\n");
  EXPECT_DOUBLE_EQ(free_memory(folder), 0.95 * 910000);
  put("memory.max", "max\n");
  EXPECT_GT(free_memory(folder), 1e6);
  put("memory/memory.limit_in_bytes", "500000\n");
  put("memory/memory.usage_in_bytes", "400000\n");
  put("memory/memory.stat", "active_file 1\ntotal_active_file 100000\ntotal_inactive_file 0\n");
  EXPECT_DOUBLE_EQ(free_memory(folder), 0.95 * 200000);
  std::filesystem::remove_all(folder);
}

TEST(Memory, CapHoldsAsLongAsItLives) {
  rlimit before{}, within{}, after{};
  getrlimit(RLIMIT_AS, &before);
  const double free = free_memory();
  EXPECT_GT(free, 1e7);
  {
    const MemoryCap cap;
    getrlimit(RLIMIT_AS, &within);
    EXPECT_LE(free_memory(), 1.2 * free);
  }
  getrlimit(RLIMIT_AS, &after);
  EXPECT_LT(within.rlim_cur, RLIM_INFINITY);
  EXPECT_EQ(after.rlim_cur, before.rlim_cur);
}

}  // namespace
}  // namespace zwang
