// Google Benchmark program of the collision queries: one pair by triangle count and gap, with FCL's and Bullet's
// answers to the same. `collision_benchmark --benchmark_filter=pair`.
#include <benchmark/benchmark.h>

#include <span>

#include <zwang/bench/collision/bullet_sweep.h>
#include <zwang/bench/collision/study.h>

namespace zwang {
namespace {

constexpr int placements = 50;
constexpr double micrometre = 1e-6;

PairBench pairs_of(const benchmark::State& state) {
  return make_pairs(static_cast<std::size_t>(state.range(0)), static_cast<double>(state.range(1)) * micrometre,
                    "sliding", placements);
}

template <class Query>
void ask(benchmark::State& state, const PairBench& bench, Query query) {
  std::size_t k = 0;
  for (auto _ : state) benchmark::DoNotOptimize(query(bench.placements[k++ % bench.placements.size()]));
}

void pair_zwang(benchmark::State& state) {
  const PairBench bench = pairs_of(state);
  collision::World world;
  world.add(bench.tree);
  const int finger = world.add(bench.finger);
  ask(state, bench, [&](const PairBench::Placement& p) {
    world.place(finger, p.pose);
    const collision::Move move{finger, p.twist};
    return world.time_of_contact({&move, 1}).time;
  });
}

void pair_fcl_advancement(benchmark::State& state) {
  const PairBench bench = pairs_of(state);
  const Witness witness(std::span(&bench.tree, 1));
  ask(state, bench,
      [&](const PairBench::Placement& p) { return witness.advance(bench.finger, p.pose, p.twist, 0, 1e-4).time; });
}

void pair_bullet_sweep(benchmark::State& state) {
  const PairBench bench = pairs_of(state);
  const BulletSweep sweep(*bench.tree);
  ask(state, bench,
      [&](const PairBench::Placement& p) { return sweep.time(bench.finger, p.pose, retract(p.pose, p.twist)); });
}

BENCHMARK(pair_zwang)
    ->ArgsProduct({{1000, 10000, 100000, 1000000}, {200, 2000, 20000}})
    ->ArgNames({"triangles", "gap_um"});
BENCHMARK(pair_fcl_advancement)->ArgsProduct({{1000, 10000, 100000}, {200, 2000}})->ArgNames({"triangles", "gap_um"});
BENCHMARK(pair_bullet_sweep)->ArgsProduct({{1000, 10000, 100000}, {200, 2000}})->ArgNames({"triangles", "gap_um"});

}  // namespace
}  // namespace zwang

BENCHMARK_MAIN();
