#include <zwang/bench/collision/suite.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include <zwang/bench/collision/study.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/bench/timing/conditions.h>

namespace zwang {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json to_json(const HandStudy& s) {
  return {{"scene", s.scene},
          {"parts", s.parts},
          {"speed", s.speed},
          {"spin", s.spin},
          {"triangles", s.triangles},
          {"pieces", s.pieces},
          {"bytes_per_triangle", s.bytes_per_triangle},
          {"frames", s.frames},
          {"median", s.median},
          {"touching_median", s.touching_median},
          {"p95", s.p95},
          {"p99", s.p99},
          {"worst", s.worst},
          {"whole_median", s.whole_median},
          {"whole_p99", s.whole_p99},
          {"touches", s.search},
          {"manifold", s.completion},
          {"toc", s.sweep},
          {"raw", s.raw},
          {"most_raw", s.most_raw},
          {"kept", s.kept},
          {"truncations", s.truncations},
          {"held", s.held},
          {"completed", s.completed},
          {"overlaps", s.overlaps},
          {"gap", s.gap},
          {"body_frames", s.body_frames},
          {"touching", s.touching},
          {"audited", s.audited},
          {"penetrations", s.penetrations},
          {"seconds", s.seconds}};
}

json to_json(const PairStudy& s) {
  return {{"triangles", s.triangles},
          {"gap", s.gap},
          {"motion", s.motion},
          {"placements", s.placements},
          {"smallest_gap", s.smallest_gap},
          {"true_hits", s.true_hits},
          {"times", {{"zwang", s.ours}, {"fcl", s.fcl}, {"bullet", s.bullet}}},
          {"p95", {{"zwang", s.ours_p95}, {"fcl", s.fcl_p95}, {"bullet", s.bullet_p95}}},
          {"stops", {{"zwang", s.ours_stop}, {"fcl", s.fcl_stop}, {"bullet", s.bullet_stop}}},
          {"hits", {{"zwang", s.ours_hits}, {"fcl", s.fcl_hits}, {"bullet", s.bullet_hits}}}};
}

json described(const Conditions& c) {
  return {{"version", c.version},   {"commit", c.commit + (c.dirty ? " (changed)" : "")},
          {"compiler", c.compiler}, {"flags", c.flags},
          {"build", c.build_type},  {"CPU", c.cpu},
          {"cores", c.cores},       {"libraries", c.libraries}};
}

void write(const fs::path& file, const json& results) {
  const fs::path beside = file.string() + ".new";
  std::ofstream out(beside);
  out << results.dump(1) << '\n';
  out.close();
  if (!out) throw std::runtime_error("cannot write " + beside.string());
  fs::rename(beside, file);
}

std::string printed(const char* format, auto... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
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
  const fs::path file = options.directory / "collision.json";
  json results = {{"suite", "collision"},   {"command", options.command}, {"conditions", described(conditions())},
                  {"pairs", json::array()}, {"frames", json::array()},    {"audits", json::array()}};
  std::vector<std::string> lines;
  Progress progress(options.terminal);
  const auto begin = std::chrono::steady_clock::now();
  double steps = 12, finished = 0;
  for (const HandScene& scene : options.hands) steps += 1.0 + 2.0 * static_cast<double>(scene.speeds.size());
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
      results["pairs"].push_back(to_json(s));
      write(file, results);
      if (triangles == 100000 && gap < 1e-3)
        lines.push_back(
            printed("A finger %s on 100k triangles: %.1f us; conservative advancement over fcl::distance "
                    "%.0f us (%.0fx), Bullet's convexSweepTest %.0f us (%.0fx)",
                    motion, 1e6 * s.ours, 1e6 * s.fcl, s.fcl / s.ours, 1e6 * s.bullet, s.bullet / s.ours));
    }

  // The hands: for time, then audited.
  Totals all;
  for (const HandScene& scene : options.hands) {
    if (!next(scene.name + ": loading")) return lines;
    const HandScene::Start start = scene.load();
    for (const bool audited : {false, true})
      for (const double speed : scene.speeds) {
        if (!next(scene.name + (audited ? ": audit" : ""))) return lines;
        const HandStudy s = study_hand(scene, start, speed, audited);
        results[audited ? "audits" : "frames"].push_back(to_json(s));
        write(file, results);
        if (audited)
          all.add(s);
        else if (speed <= 0.5)
          lines.push_back(
              printed("Hand on %s at %.1f m/s: median %.2f ms (touching %.2f), p99 %.2f, worst %.2f; contacts "
                      "%.0f -> %.0f",
                      s.scene.c_str(), s.speed, 1e3 * s.median, 1e3 * s.touching_median, 1e3 * s.p99, 1e3 * s.worst,
                      s.raw, s.kept));
      }
  }
  progress.clear();
  lines.push_back(
      printed("Audit: %ld penetrations in %s body-frames (%s touching; %s poses checked by FCL), smallest "
              "gap %.2g um",
              all.penetrations, grouped(static_cast<std::size_t>(all.body_frames)).c_str(),
              grouped(static_cast<std::size_t>(all.touching)).c_str(),
              grouped(static_cast<std::size_t>(all.audited)).c_str(), 1e6 * all.gap));
  results["headline"] = lines;
  write(file, results);
  done = true;
  return lines;
}

}  // namespace zwang
