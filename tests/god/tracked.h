#pragma once

#include "bench/collision/meshes.h"
#include "bench/scenes/physical.h"
#include "experiments/god/simulation.h"

namespace zwang::god {

inline Pose<double> at(double x, double y, double z, const Vec3& turn = Vec3::Zero()) {
  return {{x, y, z}, rotation(turn)};
}

inline Target hand_at(const Pose<double>& palm, double curl = 0) {
  Target t{.palm = palm};
  for (int k = 0; k < hand::angles; ++k)
    if (k % 4 != 1) t.angles[static_cast<std::size_t>(k)] = curl * hand::range(k).high;
  return t;
}

inline Options unverified() {
  Options o;
  o.verify = 0;
  return o;
}

inline Simulation one_hand(const Surroundings& surroundings, const Target& start,
                           const Options& options = unverified()) {
  return Simulation(surroundings, std::span(&hand::standard(), 1), std::span(&start, 1), options);
}

inline const Frame& go(Simulation& simulation, const Target& target) { return simulation.step(std::span(&target, 1)); }

inline Object fixed(collision::Mesh mesh, const Pose<double>& pose = {}) {
  return {.name = "part", .mesh = std::make_shared<const collision::Tree>(std::move(mesh)), .pose = pose};
}

}  // namespace zwang::god
