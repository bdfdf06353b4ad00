// Google Benchmark program of the collision queries: one pair by triangle count and gap, with FCL's and Bullet's
// answers to the same. `collision_benchmark --benchmark_filter=pair`.
#include <benchmark/benchmark.h>

#include <zwang/bench/collision/study.h>

namespace zwang {
namespace {

void pair(benchmark::State& state, const std::string& method) {
  const PairBench bench =
      make_pairs(static_cast<std::size_t>(state.range(0)), 1e-6 * static_cast<double>(state.range(1)), "sliding", 50);
  const PairBench::Query query = bench.query(method);
  std::size_t k = 0;
  for (auto _ : state) benchmark::DoNotOptimize(query(bench.placements[k++ % bench.placements.size()]));
}

BENCHMARK_CAPTURE(pair, zwang, "zwang")
    ->ArgsProduct({{1000, 10000, 100000, 1000000}, {200, 2000, 20000}})
    ->ArgNames({"triangles", "gap_um"});
BENCHMARK_CAPTURE(pair, fcl_advancement, "fcl")
    ->ArgsProduct({{1000, 10000, 100000}, {200, 2000}})
    ->ArgNames({"triangles", "gap_um"});
BENCHMARK_CAPTURE(pair, bullet_sweep, "bullet")
    ->ArgsProduct({{1000, 10000, 100000}, {200, 2000}})
    ->ArgNames({"triangles", "gap_um"});

}  // namespace
}  // namespace zwang

BENCHMARK_MAIN();
