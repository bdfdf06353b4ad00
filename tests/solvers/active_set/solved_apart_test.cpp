// Problems of several islands: solved as each alone, and without allocations whatever sizes stand side by side.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/timing/allocations.h>
#include <zwang/solvers/active_set/dual_active_set.h>
#include <zwang/solvers/registry.h>
#include "tests/solvers/random_mechanism.h"
#include "tests/solvers/side_by_side.h"

namespace zwang {
namespace {

using test::Graph, test::graphs, test::random_mechanism, test::seeds, test::side_by_side;

TEST(SolvedApart, AsEachAlone) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Problem parts[] = {random_mechanism(Graph::floating_tree, seed), random_mechanism(Graph::loops, seed + 1),
                             random_mechanism(Graph::grounded_tree, seed + 2)};
    DualActiveSet together, apart;
    Solution whole, own;
    together.solve(side_by_side(parts), {}, whole);
    Index begin = 0;
    for (const Problem& part : parts) {
      apart.solve(part, {}, own);
      ASSERT_EQ(own.z.size(), part.size()) << part.name;
      EXPECT_EQ(whole.z.segment(begin, part.size()), own.z) << part.name;
      begin += part.size();
    }
    ASSERT_EQ(whole.z.size(), begin) << seed;
  }
}

// Cold and warm, frame by frame; the second time round nothing is allocated.
void expect_no_allocations(AnySolver solver, std::span<const Problem> frames) {
  std::vector<WarmStart> starts;
  std::vector<Solution> solutions(frames.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    solver.solve(frames[k], {}, solutions[k]);
    ASSERT_TRUE(solutions[k].z.size() > 0 || solutions[k].certificate.size() > 0)
        << to_string(solutions[k].status) << ": " << solutions[k].message;
    starts.push_back({frames[k].key, solutions[k].lambda});
  }
  const auto solve_all = [&] {
    for (std::size_t k = 0; k < frames.size(); ++k) {
      solver.solve(frames[k], {}, solutions[k]);
      solver.solve(frames[k], {.warm_start = &starts[k]}, solutions[k]);
    }
  };
  solve_all();
  const long before = allocations();
  solve_all();
  EXPECT_EQ(allocations() - before, 0);
}

Problem scene(const char* spec) { return make_scenes(spec).front().problem; }

class SolvedApart : public testing::TestWithParam<const char*> {};

TEST_P(SolvedApart, BodiesOfAllSizesAllocateNothing) {
  const Problem parts[] = {scene("hand(contacts=16)"), scene("tower(boxes=5)"), scene("hand(contacts=4)"),
                           scene("CHAIN(links=3)"), scene("tower(boxes=16)")};
  expect_no_allocations(make_solver(GetParam()), std::array{side_by_side(parts)});
}

// Trees and loops of equal size that are connected otherwise, and joints whose rank only the careful path decides.
TEST_P(SolvedApart, UnlikeMechanismsAllocateNothing) {
  std::vector<Problem> parts;
  for (const Graph graph : graphs)
    for (unsigned seed = 0; seed < seeds(graph, 20); ++seed) parts.push_back(random_mechanism(graph, seed));
  expect_no_allocations(make_solver(GetParam()), std::array{side_by_side(parts)});
}

// A hand whose weld a limit contradicts, among hands that move, and the same hand moving: one frame has a certificate
// where the other has a motion.
TEST_P(SolvedApart, PartsThatCannotMoveAllocateNothing) {
  const Problem moves = scene("hand(limits=20,drift=0)"), moves_too = scene("hand(contacts=4)"),
                stuck = scene("hand(limits=20,drift=0,locked=1)");
  const Problem parts[] = {moves, stuck, moves_too};
  expect_no_allocations(make_solver(GetParam()), std::array{side_by_side(parts), stuck, moves});
}

INSTANTIATE_TEST_SUITE_P(Solvers, SolvedApart,
                         testing::Values("dual_active_set", "nnls:reduce=on", "cholesky:reduce=on"),
                         [](const auto& i) { return std::string(i.param).substr(0, std::string(i.param).find(':')); });

TEST(SolvedApart, ContactsThatComeAndGoAllocateNothing) {
  const Problem a = scene("hand(contacts=16)"), b = scene("hand(contacts=4)"), c = scene("hand(contacts=64)");
  expect_no_allocations(make_solver("dual_active_set"),
                        std::array{side_by_side(std::array{a, b}), side_by_side(std::array{b, a}),
                                   side_by_side(std::array{c, a}), side_by_side(std::array{b, b})});
}

}  // namespace
}  // namespace zwang
