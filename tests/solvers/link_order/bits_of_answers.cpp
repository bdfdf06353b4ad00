// Prints the bits of the native solvers' answers, a line a solver. Linked twice, the objects in opposite orders, it
// prints the same: no inline function exists in two versions of which the linker picks one.
#include <bit>
#include <cinttypes>
#include <cstdio>

#include <zwang/core/problem/mix_bits.h>
#include <zwang/solvers/registry.h>
#include "tests/solvers/brute_force.h"
#include "tests/solvers/random_mechanism.h"

namespace zwang {
namespace {

std::vector<Problem> problems() {
  std::vector<Problem> all;
  for (unsigned seed = 0; seed < 200; ++seed) all.push_back(random_small_problem(seed));
  for (const test::Graph graph : test::graphs)
    for (unsigned seed = 0; seed < test::seeds(graph, 20); ++seed) all.push_back(test::random_mechanism(graph, seed));
  return all;
}

void print_bits_of_answers() {
  const std::vector<Problem> all = problems();
  std::vector<std::string> names = {"dual_active_set:reduce=off", "nnls:reduce=on", "cholesky:reduce=on"};
  for (const SolverEntry& entry : solvers())
    if (!entry.foreign) names.push_back(entry.name);
  for (const std::string& name : names) {
    AnySolver solver = make_solver(name);
    std::uint64_t bits = 0;
    int solved = 0;
    for (const Problem& p : all) {
      const Solution s = solver.solve(p, {.max_iterations = 200});
      solved += s.status == Status::solved;
      for (const Vector* v : {&s.z, &s.lambda})
        for (const double x : *v) bits = mix_bits(bits ^ std::bit_cast<std::uint64_t>(x));
    }
    std::printf("%s: %d solved, %016" PRIx64 "\n", name.c_str(), solved, bits);
  }
}

}  // namespace
}  // namespace zwang

int main() { zwang::print_bits_of_answers(); }
