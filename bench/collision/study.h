#pragma once

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
  double search = 0, completion = 0, sweep = 0;   // s, means
  double raw = 0, kept = 0, most_raw = 0;         // contacts per frame
  long truncations = 0, held = 0, completed = 0;  // truncations: sub-steps that go on after a time of contact
  long overlaps = 0;                              // frames that end with a gap that is not positive
  double gap = 1;                                 // m, the smallest at a frame's end
  long body_frames = 0, touching = 0;             // touching: nearer than 0.5 mm to an obstacle
  long audited = 0, penetrations = 0;             // poses, those between frames included; of these: that overlap
  double seconds = 0;                             // wall clock, all in
};

// `audited`: FCL sees every committed pose, and as many between two as keep the steps below a body's radius.
HandStudy study_hand(const HandScene& scene, const HandScene::Start& start, double speed, bool audited);

// One pair, many placements: a finger (a capsule) at a gap over a bumpy sphere, moving 1 mm.
struct PairStudy {
  std::size_t triangles = 0;
  double gap = 0;      // m
  std::string motion;  // "pressing", "sliding", "passing"
  int placements = 0;
  double ours = 0, fcl = 0, bullet = 0;                 // s, medians, cold: tree walk, distances and time of contact
  double ours_p95 = 0, fcl_p95 = 0, bullet_p95 = 0;     // s
  double ours_stop = 0, fcl_stop = 0, bullet_stop = 0;  // m, mean gap where a motion that is stopped ends
  int ours_hits = 0, fcl_hits = 0, bullet_hits = 0, true_hits = 0;
  double smallest_gap = 1;  // m, after our motions
};

struct PairBench {
  std::shared_ptr<const collision::Tree> tree;
  collision::Shape finger;
  struct Placement {
    Pose<double> pose;
    Vec<double, 6> twist;
  };
  std::vector<Placement> placements;
};
PairBench make_pairs(std::size_t triangles, double gap, const std::string& motion, int count);
PairStudy study_pairs(std::size_t triangles, double gap, const std::string& motion, int count);

}  // namespace zwang
