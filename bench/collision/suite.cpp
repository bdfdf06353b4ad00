#include <zwang/bench/collision/suite.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <tuple>

#include <zwang/bench/collision/study.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/bench/timing/conditions.h>
#include <zwang/core/files/stored_file.h>

namespace zwang {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(HandStudy, scene, parts, speed, spin, triangles, pieces, bytes_per_triangle, frames,
                                   median, touching_median, p95, p99, worst, whole_median, whole_p99, touches, manifold,
                                   toc, raw, most_raw, kept, truncations, held, completed, overlaps, gap, body_frames,
                                   touching, audited, penetrations, seconds)
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
  void add(const HandStudy& s) {
    body_frames += s.body_frames, touching += s.touching, audited += s.audited, penetrations += s.penetrations;
    gap = std::min(gap, s.gap);
  }
};

}  // namespace

std::vector<std::string> run_collision_suite(const CollisionSuiteOptions& options, const std::atomic<bool>& interrupted,
                                             bool& done) {
  done = false;
  fs::create_directories(options.directory);
  json results = {{"suite", "collision"},
                  {"command", options.command},
                  {"conditions", described(conditions())},
                  {"pairs", json::array()},
                  {"frames", json::array()},
                  {"audits", json::array()},
                  {"audits_with_friction", json::array()}};
  const auto store = [&] { replace_file(options.directory / "collision.json", results.dump(1) + "\n"); };
  std::vector<std::string> lines;
  Progress progress(options.terminal);
  const auto begin = std::chrono::steady_clock::now();
  double steps = 12, finished = 0;
  for (const HandScene& scene : options.hands) steps += 1.0 + 4.0 * static_cast<double>(scene.speeds.size());
  const auto next = [&](const std::string& what) {
    const double fraction = finished++ / steps;
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    progress.show(fraction, what, fraction > 0.05 ? spent * (1 - fraction) / fraction : -1);
    return !interrupted;
  };

  // Pairs.
  for (const std::size_t triangles : {1000, 10000, 100000, 1000000})
    for (const auto& [gap, motion] : {std::pair(2e-4, "sliding"), {2e-4, "pressing"}, {2e-3, "passing"}}) {
      if (!next("pairs, " + grouped(triangles) + " triangles, " + motion)) return lines;
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
  for (const HandScene& scene : options.hands) {
    if (!next(scene.name + ": loading")) return lines;
    const HandScene::Start start = scene.load();
    for (const auto& [run, key, words] :
         {std::tuple(HandRun::timed, "frames", ""), std::tuple(HandRun::audited, "audits", ": audit"),
          std::tuple(HandRun::audited_with_friction, "audits_with_friction", ": audit with friction")})
      for (const double speed : scene.speeds) {
        if (!next(scene.name + words)) return lines;
        const HandStudy s = study_hand(scene, start, speed, run);
        results[key].push_back(s);
        store();
        if (run != HandRun::timed)
          (run == HandRun::audited ? all : with_friction).add(s);
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
  done = true;
  return lines;
}

}  // namespace zwang
