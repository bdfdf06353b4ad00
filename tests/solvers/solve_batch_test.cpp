#include <zwang/solvers/solve_batch.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/solvers/registry.h>

namespace zwang {
namespace {

std::vector<Problem> problems_of(std::string_view scenes) {
  std::vector<Problem> problems;
  for (Instance& instance : make_scenes(scenes)) problems.push_back(std::move(instance.problem));
  return problems;
}

bool same_bits(const Vector& a, const Vector& b) {
  return a.size() == b.size() &&
         (a.size() == 0 || std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0);
}

// Hands of one topology, in both orders, with towers and hands at all their limits between them.
TEST(SolveBatchTest, AnswersDependNeitherOnTheirPlaceNorOnTheNumberOfThreads) {
  std::vector<Problem> problems =
      problems_of("hand(contacts=4,16,64,seed=1..4),tower(boxes=3,5),hand(limits=20,contacts=100,seed=1..3)");
  for (const char* name : {"dual_active_set", "nnls", "newton"}) {
    std::vector<Solution> alone(problems.size());
    for (std::size_t k = 0; k < problems.size(); ++k) make_solver(name).solve(problems[k], {}, alone[k]);
    for (const int threads : {1, 2, 5}) {
      BatchSolver batch(make_solver(name), threads);
      for (const bool reversed : {false, true, false}) {
        std::vector<Problem> ordered = problems;
        if (reversed) std::ranges::reverse(ordered);
        std::vector<Solution> solutions(ordered.size());
        batch.solve(ordered, {}, solutions);
        if (reversed) std::ranges::reverse(solutions);
        for (std::size_t k = 0; k < problems.size(); ++k) {
          EXPECT_EQ(solutions[k].status, alone[k].status) << name << " " << problems[k].name;
          EXPECT_TRUE(same_bits(solutions[k].z, alone[k].z)) << name << " " << problems[k].name << ", " << threads;
          EXPECT_TRUE(same_bits(solutions[k].lambda, alone[k].lambda)) << name << " " << problems[k].name;
        }
      }
    }
  }
}

TEST(SolveBatchTest, AnEmptyBatchAndMoreThreadsThanProblems) {
  BatchSolver batch(make_solver("dual_active_set"), 8);
  batch.solve({}, {}, {});
  const std::vector<Problem> one = problems_of("tower(boxes=2)");
  std::vector<Solution> solutions(1);
  batch.solve(one, {}, solutions);
  EXPECT_EQ(solutions[0].status, Status::solved);
  EXPECT_GE(BatchSolver(make_solver("dual_active_set")).threads(), 1);
}

TEST(SolveBatchTest, RefusesWrongUse) {
  EXPECT_THROW(BatchSolver(make_solver("dual_active_set"), -1), std::invalid_argument);
  BatchSolver batch(make_solver("dual_active_set"), 2);
  std::vector<Problem> problems = problems_of("tower(boxes=2..9)");
  std::vector<Solution> solutions(problems.size());
  EXPECT_THROW(batch.solve(problems, {}, std::span(solutions).first(2)), std::invalid_argument);
  SolveOptions watched;
  watched.observe = [](int, const Vector&, const Vector&) {};
  EXPECT_THROW(batch.solve(problems, watched, solutions), std::invalid_argument);
  // The others are solved all the same.
  problems[3].c.conservativeResize(1);
  EXPECT_THROW(batch.solve(problems, {}, solutions), std::invalid_argument);
  for (std::size_t k = 0; k < problems.size(); ++k) EXPECT_EQ(solutions[k].status == Status::solved, k != 3) << k;
}

}  // namespace
}  // namespace zwang
