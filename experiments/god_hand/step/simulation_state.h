#pragma once

#include <optional>
#include <vector>

#include <zwang/experiments/god_hand/measure/measures.h>
#include <zwang/experiments/god_hand/step/coupling.h>
#include <zwang/experiments/god_hand/step/physics.h>
#include <zwang/experiments/god_hand/step/resolution.h>
#include <zwang/experiments/god_hand/step/simulation.h>

namespace zwang::god {

struct Simulation::State {
  State(Surroundings surroundings, const Options& options);

  // Takes the clusters over; `target` has their poses already. `easy`: as target, where a hand does not touch itself.
  void build(std::vector<GodObjects> objects, std::span<const Pose<double>> easy);
  void step();
  // Every number of the state between frames: visit(number), for writing and for reading.
  template <class Visit>
  void each_number(bool reading, const Visit& visit);

  Surroundings surroundings;
  Options options;
  std::vector<hand::Model> models;
  std::vector<Cluster> clusters;
  std::vector<std::size_t> first = {0};  // god object of each cluster, and their number
  std::vector<Pose<double>> target;      // of all god objects, the last that was tracked
  std::optional<Physics> physics;        // where something is loose
  std::optional<Resolution> resolution;
  std::optional<Coupling> coupling;
  std::optional<Measures> measures;
  std::vector<Pose<double>> object, object_before, god;
  std::vector<Pose<double>> wanted;  // of all god objects, where the hands are tracked now
  Watch watch = {};
  Frame frame = {};
  long number = 0;

  template <class T>
  std::span<const T> of(std::size_t cluster, const std::vector<T>& all) const {
    return std::span(all).subspan(first[cluster], first[cluster + 1] - first[cluster]);
  }

 private:
  void start(Cluster& cluster, std::span<const Pose<double>> at, std::span<const Pose<double>> easy);
  void step_physics();
  void step_god_objects();

  std::vector<Vec<double, 6>> velocity_;  // by object, before the engine's step
  std::vector<Pose<double>> last_;        // of a cluster, its targets of the frame before
  std::vector<double> toc_;               // by cluster
  std::vector<Pose<double>> from_;        // of a cluster, before a motion that is watched
};

}  // namespace zwang::god
