#pragma once

#include <span>
#include <vector>

#include <zwang/experiments/god_hand/scenes/surroundings.h>
#include <zwang/experiments/god_hand/step/frame.h>

namespace zwang::god {

// A contact of what is held.
struct Holding {
  Vec3 point;   // m, from the object's centre of mass, world
  Vec3 along;   // unit, into the object
  double push;  // N, along it
};

// How large a force [N] at the centre of mass, in the worst of 26 directions (to the sides, edges and corners of a cube
// along the world's axes), the contacts can hold beside the weight: each with any force in Coulomb's cone, the normal
// forces together no larger than they are. 0 where they cannot hold the weight. A linear program over the rays of the
// cones, each ray found where it is needed: the optimum of the cone program, to 1e-9 of the sum of the pushes.
double largest_disturbance(std::span<const Holding> contacts, const Vec3& weight, double mu);

// What the object that is held hardest in a frame is held by.
struct Held {
  std::vector<Holding> contacts = {};
  Vec3 weight = Vec3::Zero();  // N
};
Held held_hardest(const Frame& frame, const Surroundings& surroundings);

}  // namespace zwang::god
