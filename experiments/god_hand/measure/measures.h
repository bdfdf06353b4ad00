#pragma once

#include <span>
#include <vector>

#include <zwang/collision/world.h>
#include <zwang/experiments/god_hand/scenes/depth.h>
#include <zwang/experiments/god_hand/step/cluster.h>

namespace zwang::god {

// The measures of a frame, from poses and shapes; of the solves they use which contacts were rows, and how many rows
// there were.
class Measures {
 public:
  // models: of the hands, which the clusters are made of one after the other; none: god objects of other kinds.
  Measures(const Surroundings& surroundings, std::span<const Cluster> clusters, std::span<const hand::Model> models);

  // Before the god objects move.
  void begin(std::span<const Cluster> clusters, PoseSpan objects);
  // After it: what a stream shows (docs/stream.md): poses, targets, held, the device's forces.
  void show(std::span<const Cluster> clusters, const Options& options, Frame& frame) const;
  // After that, all the rest. objects: the poses of all.
  void measure(std::span<Cluster> clusters, PoseSpan objects, const Options& options, Frame& frame);

  // What is kept from frame to frame: god objects and targets of the last two frames.
  struct Memory {
    std::vector<Pose<double>> god[2], target[2];
    double still = 0;          // s, since when no target has moved
    std::vector<double> late;  // s, by object: since when it is pressed though no target presses it
  };
  Memory& memory() { return memory_; }

 private:
  double lost_slide(const Cluster& cluster) const;
  bool stuck(Cluster& cluster, std::size_t first) const;
  double jitter(const Frame& frame) const;
  void measure_grip(PoseSpan objects, const Options& options, Frame& frame);
  void measure_depth(PoseSpan objects, Frame& frame);

  std::vector<std::vector<Ball>> balls_;  // by hand
  Depth depth_;
  collision::World sight_;  // a speck, and the objects
  Scenery scenery_;
  std::vector<Pose<double>> start_;         // of the god objects, before they moved
  std::vector<Pose<double>> start_object_;  // of the objects
  std::vector<bool> loose_;                 // by object
  std::vector<double> pressed_;             // N, by object
  std::vector<char> wanted_;                // by object: a target presses it
  Memory memory_;
};

}  // namespace zwang::god
