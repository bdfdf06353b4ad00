#include <zwang/bench/timing/child.h>

#include <gtest/gtest.h>

#include <zwang/bench/timing/solve_service.h>
#include "tests/bench/suite/test_solvers.h"

namespace zwang {
namespace {

const std::vector<SolverEntry> solvers_here = {tests::entry<tests::AllActive>(true), tests::entry<tests::Hangs>(true),
                                               tests::entry<tests::Sleeps>(true), tests::entry<tests::Aborts>(true),
                                               tests::entry<tests::Throws>(true)};

AnySolver make(std::string_view text) { return make_solver(text, solvers_here); }

SolveRequest call(std::string solver, double time_limit = 0.1) {
  SolveRequest c;
  c.solver = std::move(solver);
  c.time_limit = time_limit;
  return c;
}

TEST(Child, GivesTheBitsThatTheSolverGivesHere) {
  const Problem p = tests::chain(7).problem;
  Child child(make);
  child.load(p);
  SolveService here(make);
  const SolveReply there = child.run(call("all_active")), expected = here.run(p, call("all_active"));
  EXPECT_EQ(there.solution.status, Status::solved);
  EXPECT_EQ(there.solution.z, expected.solution.z);
  EXPECT_EQ(there.solution.lambda, expected.solution.lambda);
  EXPECT_GT(there.seconds, 0);
}

TEST(Child, SendsTheObservedIterates) {
  const Problem p = tests::chain(3).problem;
  Child child(make);
  child.load(p);
  SolveRequest c = call("all_active");
  c.observe = true;
  const SolveReply a = child.run(c);
  ASSERT_EQ(a.iterates.size(), 4u);
  EXPECT_EQ(a.iterates[3].iteration, 4);
  EXPECT_EQ(a.iterates[3].z, a.solution.z / 2);
}

TEST(Child, SendsWhatASolutionSaysOfItself) {
  SolveReply sent;
  sent.solution.handed_to = "nnls";
  sent.solution.range_gap = 0.25;
  sent.solution.error_bound = 0.125;
  sent.solution.message = "said";
  const Solution got = unpack<SolveReply>(pack(sent)).solution;
  EXPECT_EQ(got.handed_to, "nnls");
  EXPECT_EQ(got.range_gap, 0.25);
  EXPECT_EQ(got.error_bound, 0.125);
  EXPECT_EQ(got.message, "said");
}

// Such iterates take fewer bytes on the wire than in memory.
TEST(Child, SendsIteratesOfFewNumbers) {
  SolveReply sent;
  for (int i = 1; i <= 40; ++i) sent.iterates.push_back({i, Vector::Constant(i % 2, 0.5), {}});
  const std::string bytes = pack(sent);
  const SolveReply got = unpack<SolveReply>(bytes);
  ASSERT_EQ(got.iterates.size(), 40u);
  EXPECT_EQ(got.iterates[38].z, Vector::Constant(1, 0.5));
  EXPECT_EQ(got.iterates[39].iteration, 40);
  EXPECT_THROW(unpack<SolveReply>(std::string_view(bytes).substr(0, bytes.size() - 1)), std::runtime_error);
}

TEST(Child, IsKilledAtItsDeadlineAndAnswersAgain) {
  const Problem p = tests::chain(4).problem;
  Child child(make);
  child.load(p);
  const SolveReply hung = child.run(call("hangs"));
  EXPECT_EQ(hung.solution.status, Status::time_limit);
  EXPECT_EQ(hung.solution.z.size(), 0);
  EXPECT_GE(hung.seconds, 0.1);
  EXPECT_EQ(child.run(call("all_active")).solution.status, Status::solved);
}

TEST(Child, IsKilledWhenItSleeps) {
  const Problem p = tests::chain(4).problem;
  Child child(make);
  child.load(p);
  EXPECT_EQ(child.run(call("sleeps", 0.01)).solution.status, Status::time_limit);
}

TEST(Child, DiesAndAnswersAgain) {
  const Problem p = tests::chain(4).problem;
  Child child(make);
  child.load(p);
  EXPECT_EQ(child.run(call("aborts")).solution.status, Status::crashed);
  EXPECT_EQ(child.run(call("all_active")).solution.status, Status::solved);
}

TEST(Child, TurnsAnExceptionIntoAStatus) {
  const Problem p = tests::chain(4).problem;
  Child child(make);
  child.load(p);
  const SolveReply a = child.run(call("throws"));
  EXPECT_EQ(a.solution.status, Status::numerical_failure);
  EXPECT_EQ(a.solution.message, "threw: no memory for this");
}

TEST(Child, StopsWhenInterrupted) {
  const Problem p = tests::chain(4).problem;
  Child child(make);
  child.load(p);
  const std::atomic<bool> interrupted = true;
  EXPECT_EQ(child.run(call("hangs", 100), &interrupted).solution.status, Status::unsolved);
}

TEST(Wire, CarriesAProblemBitForBit) {
  Problem p = tests::chain(5).problem;
  p.c[2] = -0.0;
  p.kind[1] = RowKind::inequality;
  const Problem q = unpack<Problem>(pack(p));
  EXPECT_EQ(q.name, p.name);
  EXPECT_EQ(Matrix(q.M), Matrix(p.M));
  EXPECT_EQ(Matrix(q.J), Matrix(p.J));
  EXPECT_EQ(q.z_u, p.z_u);
  EXPECT_TRUE(std::signbit(q.c[2]));
  EXPECT_EQ(q.kind, p.kind);
  EXPECT_EQ(q.key, p.key);
}

TEST(Wire, RefusesAMessageThatEndsEarly) {
  const std::string whole = pack(tests::chain(5).problem);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(unpack<Problem>(std::string_view(whole).substr(0, size)), std::runtime_error) << size;
}

}  // namespace
}  // namespace zwang
