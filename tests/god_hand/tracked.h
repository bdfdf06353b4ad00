#pragma once

#include <gtest/gtest.h>

#include <zwang/bench/collision/meshes.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/experiments/god_hand/simulation.h>

namespace zwang::god {

inline Pose<double> posed(double x, double y, double z, const Vec3& turn = Vec3::Zero()) {
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
  o.mu = 0;
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

// A floor whose top is at z = 0, of some thousand triangles.
inline Surroundings floor_of(std::size_t triangles = 5000) {
  Surroundings s{.name = "floor"};
  s.objects.push_back(fixed(meshes::plate({1, 1, 0.1}, triangles), {{0, 0, -0.05}, Mat3::Identity()}));
  return s;
}

inline Surroundings sheet() {
  Surroundings s{.name = "sheet"};
  s.objects.push_back(fixed(meshes::sheet(1, 1, 800)));
  return s;
}

inline void expect_sound(const Frame& f) {
  ASSERT_GT(f.gap, 0) << "frame " << f.number;
  ASSERT_LE(f.separation, 1e-12) << "frame " << f.number;
  ASSERT_LE(f.limit, 1e-12) << "frame " << f.number;
  ASSERT_TRUE(f.claimed == Status::solved || f.claimed == Status::solved_ill_conditioned) << to_string(f.claimed);
}

}  // namespace zwang::god
