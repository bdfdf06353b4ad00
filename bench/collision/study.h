#pragma once

#include <map>

#include <zwang/bench/collision/moving_hand.h>

namespace zwang {

// A run of a moving hand: figures over its frames. Times [s] are thread CPU time of the collision calls, but for
// `whole`.
struct HandStudy {
  std::string scene, parts;
  double speed = 0, spin = 0;
  std::size_t triangles = 0, pieces = 0;
  double bytes_per_triangle = 0;
  int frames = 0;
  double median = 0, touching_median = 0, p95 = 0, p99 = 0, worst = 0;
  double whole_median = 0, whole_p99 = 0;         // s, of everything that a frame does
  double touches = 0, manifold = 0, toc = 0;      // s, means: search for contacts, rows given back, times of contact
  double raw = 0, kept = 0, most_raw = 0;         // contacts per frame
  long truncations = 0, held = 0, completed = 0;  // truncations: sub-steps that go on after a time of contact
  long overlaps = 0;                              // frames that end with a gap that is not positive
  double gap = 1;                                 // m, the smallest at a frame's end
  long body_frames = 0, touching = 0;             // touching: nearer than hand::touching
  long audited = 0, penetrations = 0;             // poses, those between frames included; of these: that overlap
  double seconds = 0;                             // wall clock, all in
};

// timed: without friction, alone. Else FCL sees every committed pose, and as many between two as keep the steps below a
// body's radius.
enum class HandRun { timed, audited, audited_with_friction };
HandStudy study_hand(const HandScene& scene, const HandScene::Start& start, double speed, HandRun run);

// A finger (a capsule) over a bumpy sphere, and motions of 1 mm that start at one gap from it, asked of every method:
// zwang, fcl, bullet.
struct PairStudy {
  std::size_t triangles = 0;
  double gap = 0;  // m
  std::string motion;
  int placements = 0;
  std::map<std::string, double> times = {}, p95 = {};  // s, medians and 95th percentiles of cold queries
  std::map<std::string, double> stops = {};            // m, mean gap where a motion that is stopped ends
  std::map<std::string, int> hits = {};
  int true_hits = 0;
  double smallest_gap = 1;  // m, after our motions
};
// motion: "pressing", "sliding", "passing".
PairStudy study_pairs(std::size_t triangles, double gap, const std::string& motion, int count);

}  // namespace zwang
