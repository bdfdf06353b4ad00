#pragma once

#include <cstdint>

#include <zwang/bench/collision/drag_scenes.h>
#include <zwang/bench/collision/witness.h>

namespace zwang {

// A run of the dragged hand: figures over its frames. Times [s] are thread CPU time of the collision calls.
struct DragStudy {
  std::string scene, parts;
  double speed = 0, spin = 0;
  std::size_t triangles = 0, pieces = 0;
  double bytes_per_triangle = 0;
  int frames = 0;
  double median = 0, touching_median = 0, p95 = 0, p99 = 0, worst = 0;
  double touches = 0, manifold = 0, toc = 0;  // s, means of the parts
  double raw = 0, kept = 0, most_raw = 0;     // contacts per frame
  long truncations = 0, held = 0, completed = 0, overlaps = 0;
  double change = 0;  // m, the largest motion of a body in one frame that lazy completion took back
  double gap = 1;     // m, the smallest committed
  long body_frames = 0, touching = 0, audited = 0, penetrations = 0;  // audited: poses, those between frames included
  double seconds = 0;                                                 // wall clock, all in
};

// audit: null for none. Every committed pose is looked at, and as many between as keep the steps below a body's radius.
DragStudy study_drag(const DragScene& scene, const DragOptions& options, const std::vector<Part>& parts,
                     const Witness* audit, int frames);

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
