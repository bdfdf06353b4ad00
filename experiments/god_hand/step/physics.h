#pragma once

#include <memory>
#include <span>

#include <zwang/experiments/god_hand/scenes/surroundings.h>

namespace zwang::god {

// The physics engine of the loose objects: Bullet, double precision. Fixed objects are what they lie on. The god
// objects are not in it: they push by the forces that step() is given. The same calls give the same bits.
class Physics {
 public:
  // Throws std::invalid_argument for a loose object without pieces, or whose axes are not its principal ones.
  explicit Physics(const Surroundings& surroundings);
  ~Physics();

  // One step of length dt [s]. wrench [N; N m] acts at the centres of mass in world axes, one per object (of fixed
  // ones: not looked at); none: no forces but gravity.
  void step(double dt, std::span<const Vec<double, 6>> wrench);

  // By object of the surroundings.
  Pose<double> pose(std::size_t object) const;
  Vec<double, 6> velocity(std::size_t object) const;  // m/s, rad/s, world axes, of the centre of mass
  void place(std::size_t object, const Pose<double>& pose, const Vec<double, 6>& velocity);

  // Drops what the engine keeps from step to step (contact points, their impulses, pairs), so that what follows depends
  // on poses and velocities alone: two worlds that are placed alike and then forget give the same bits.
  void forget();

 private:
  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace zwang::god
