#include <unistd.h>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <tuple>

#include <zwang/bench/collision/study.h>
#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/report/report.h>
#include <zwang/bench/scenes/recorded_data.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/bench/timing/conditions.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/experiments/god_hand/run/hand_study.h>
#include <zwang/experiments/program/commands.h>

namespace zwang {

namespace god {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(HandStudy, scene, parts, speed, spin, triangles, pieces, bytes_per_triangle, frames,
                                   median, touching_median, p95, p99, worst, whole_median, whole_p99, touches, manifold,
                                   toc, raw, most_raw, kept, truncations, held, completed, overlaps, gap, body_frames,
                                   touching, audited, penetrations, seconds)
}
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PairStudy, triangles, gap, motion, placements, smallest_gap, true_hits, times, p95,
                                   stops, hits)

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json described(const Conditions& c) {
  return {{"version", c.version},   {"commit", c.commit + (c.dirty ? " (changed)" : "")},
          {"compiler", c.compiler}, {"flags", c.flags},
          {"build", c.build_type},  {"CPU", c.cpu},
          {"cores", c.cores},       {"libraries", c.libraries}};
}

struct Totals {
  long body_frames = 0, touching = 0, audited = 0, penetrations = 0;
  double gap = 1;
  void add(const god::HandStudy& s) {
    body_frames += s.body_frames, touching += s.touching, audited += s.audited, penetrations += s.penetrations;
    gap = std::min(gap, s.gap);
  }
};

// Pair queries (zwang, a conservative advancement over fcl::distance, Bullet's convexSweepTest) by triangle count and
// gap; every run of the hands, once for time, once under audit, and with friction, twice as long, under audit. Results
// as collision.json after every study. `lines`: what a reader wants first. False when interrupted.
bool run_suite(const fs::path& directory, const std::string& command, std::vector<std::string>& lines) {
  const std::atomic<bool>& interrupted = stop_on_interrupt();
  const std::vector<god::HandScene> scenes = god::hand_scenes(recorded_data());
  fs::create_directories(directory);
  json results = {{"suite", "collision"},
                  {"command", command},
                  {"conditions", described(conditions())},
                  {"pairs", json::array()},
                  {"frames", json::array()},
                  {"audits", json::array()},
                  {"audits_with_friction", json::array()}};
  const auto store = [&] { replace_file(directory / "collision.json", results.dump(1) + "\n"); };
  Progress progress(isatty(STDERR_FILENO) == 1);
  const auto begin = std::chrono::steady_clock::now();
  double steps = 12, finished = 0;
  for (const god::HandScene& scene : scenes) steps += 1.0 + 4.0 * static_cast<double>(scene.speeds.size());
  const auto next = [&](const std::string& what) {
    const double fraction = finished++ / steps;
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    progress.show(fraction, what, fraction > 0.05 ? spent * (1 - fraction) / fraction : -1);
    return !interrupted;
  };

  // Pairs.
  for (const std::size_t triangles : {1000, 10000, 100000, 1000000})
    for (const auto& [gap, motion] : {std::pair(2e-4, "sliding"), {2e-4, "pressing"}, {2e-3, "passing"}}) {
      if (!next("pairs, " + grouped(triangles) + " triangles, " + motion)) return false;
      const PairStudy s = study_pairs(triangles, gap, motion, 100);
      results["pairs"].push_back(s);
      store();
      if (triangles == 100000 && gap < 1e-3)
        lines.push_back(
            printed("A finger %s on 100k triangles: %.1f us; conservative advancement over fcl::distance "
                    "%.0f us (%.0fx), Bullet's convexSweepTest %.0f us (%.0fx)",
                    motion, 1e6 * s.times.at("zwang"), 1e6 * s.times.at("fcl"), s.times.at("fcl") / s.times.at("zwang"),
                    1e6 * s.times.at("bullet"), s.times.at("bullet") / s.times.at("zwang")));
    }

  // The hands: for time, then audited.
  Totals all, with_friction;
  for (const god::HandScene& scene : scenes) {
    if (!next(scene.name + ": loading")) return false;
    const god::Surroundings surroundings = scene.make();
    for (const auto& [run, key, words] :
         {std::tuple(god::HandRun::timed, "frames", ""), std::tuple(god::HandRun::audited, "audits", ": audit"),
          std::tuple(god::HandRun::audited_with_friction, "audits_with_friction", ": audit with friction")})
      for (const double speed : scene.speeds) {
        if (!next(scene.name + words)) return false;
        const god::HandStudy s = study_hand(scene, surroundings, speed, run);
        results[key].push_back(s);
        store();
        if (run != god::HandRun::timed)
          (run == god::HandRun::audited ? all : with_friction).add(s);
        else if (speed <= 0.5)
          lines.push_back(
              printed("Hand on %s at %.1f m/s: median %.2f ms (touching %.2f), p99 %.2f, worst %.2f; contacts "
                      "%.0f -> %.0f",
                      s.scene.c_str(), s.speed, 1e3 * s.median, 1e3 * s.touching_median, 1e3 * s.p99, 1e3 * s.worst,
                      s.raw, s.kept));
      }
  }
  progress.clear();
  for (const auto& [words, of] : {std::pair("Audit", &all), std::pair("Audit with friction", &with_friction)})
    lines.push_back(
        printed("%s: %ld penetrations in %s body-frames (%s touching; %s poses checked by FCL), smallest "
                "gap %.2g um",
                words, of->penetrations, grouped(of->body_frames).c_str(), grouped(of->touching).c_str(),
                grouped(of->audited).c_str(), 1e6 * of->gap));
  results["headline"] = lines;
  store();
  return true;
}

}  // namespace

int bench_collision(const fs::path& directory, const std::string& command) {
  std::vector<std::string> lines;
  const bool whole = run_suite(directory, command, lines);
  for (const std::string& line : lines) std::printf("%s\n", line.c_str());
  if (!whole) std::printf("Stopped. What was finished is in %s\n", (directory / "collision.json").c_str());
  std::printf("Report: %s\n", report::write_report(directory).c_str());
  return whole ? done : stopped;
}

}  // namespace zwang
