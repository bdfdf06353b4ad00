#pragma once

#include <span>
#include <vector>

#include <zwang/collision/world.h>
#include <zwang/experiments/god_hand/scenes/surroundings.h>
#include <zwang/experiments/god_hand/step/physics.h>

namespace zwang::god {

// What the engine's step cost in corrections.
struct Resolved {
  int overlapping = 0;  // loose objects that were too near to a god object, or in it
  int swept = 0;        // of them, those so fast that they were stopped on their way
  int rounds = 0;       // contacts that were projected
  int returned = 0;     // objects put back to where they were before the step, velocity zeroed: no clear place nearby
  double deepest = 0;   // m, of an object in a god object, as the engine left it
};

// Section 6.2 of the paper: the engine moved the loose objects as if there were no god objects, which stood still. Now
// whatever got into one is moved out of it.
class Resolution {
 public:
  // gods: the shapes of all god objects, of all hands. Throws std::invalid_argument for more than 62 loose objects.
  Resolution(const Surroundings& surroundings, std::span<const collision::Shape> gods);

  // before: by object of the surroundings (fixed ones: not looked at), where it was before the engine's step, clear of
  // the god objects, which stand at `gods` since then. Afterwards every loose object is clear of them again.
  Resolved resolve(Physics& physics, PoseSpan before, PoseSpan gods);

 private:
  struct Loose {
    std::size_t object;
    int first, end;  // colliders
    double arm;      // m, from the centre of mass to its farthest point
    double mass;
    Vec3 inertia;
    Pose<double> pose = {}, before = {};
    Vec<double, 6> velocity = Vec<double, 6>::Zero();
    double allowed = 0;  // m, how deep it may lie in other objects
    bool near = false, met = false, swept = false, moved = false, returned = false;
  };
  // A contact of a loose object, as seen from it.
  struct Lever {
    Loose* loose = nullptr;
    Vec3 normal = {}, turn = {};  // n, away from the other; r x n
    Vec3 spin = {};               // I^-1 (r x n)
    double ease = 0;              // what an impulse of 1 along n changes the velocity along n by
  };

  struct Meeting {  // of a loose object and a god object
    Loose* loose;
    double gap;          // m
    Vec3 normal, point;  // away from the god object; on the loose one; world
  };

  void read(const Physics& physics, PoseSpan before, PoseSpan gods);
  void place(collision::World& world, const Loose& loose) const;
  bool sweep(Loose& loose);
  Lever lever(Loose& loose, const Vec3& point, const Vec3& normal) const;
  static double approach(const Lever& lever) {
    return -lever.normal.dot(lever.loose->velocity.head<3>()) - lever.turn.dot(lever.loose->velocity.tail<3>());
  }
  double lacking(const collision::Touch& touch) const;
  void project(const collision::Touch& touch, double amount);
  void put_back(Loose& loose, Resolved& out);
  void meet(double reach, double ahead);
  void slow(Physics& physics);
  Loose* loose_of(int collider) { return owner_[at(collider)]; }
  const Loose* loose_of(int collider) const { return owner_[at(collider)]; }
  bool is_god(int collider) const { return collider < static_cast<int>(gods_.size()); }

  std::vector<Object> objects_;
  std::vector<collision::Shape> gods_;
  std::vector<Pose<double>> god_pose_;
  double fast_ = 0;               // m a step: from here on an object might jump over a god object
  collision::World hands_, all_;  // god and loose objects, numbered alike; and all others after them
  std::vector<Loose> loose_;
  std::vector<Loose*> owner_;  // by collider; null: a god object or a fixed one
  std::vector<Meeting> meetings_;
  collision::FaceContacts facing_;
  std::vector<Lever> levers_;
  std::vector<collision::Path> paths_;
  std::vector<collision::Move> moves_;
};

}  // namespace zwang::god
