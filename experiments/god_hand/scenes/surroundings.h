#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <zwang/collision/shape.h>
#include <zwang/collision/tree.h>
#include <zwang/collision/world.h>

namespace zwang::god {

// What a hand may meet: fixed (mass 0: a mesh or shapes) or loose, a physics object (shapes alone: its convex pieces).
// Where a fixed object has both, hands meet the mesh and the physics engine the pieces: a table top that is cut finely
// for the hand is one box to what stands on it.
struct Object {
  struct Piece {
    collision::Shape shape;
    Pose<double> at = {};  // in the object's axes
  };

  std::string name = {};
  std::shared_ptr<const collision::Tree> mesh = {};  // of a fixed object; of a loose one: drawn, not met
  std::vector<Piece> pieces = {};
  Pose<double> pose = {};           // of the centre of mass; m, world
  double mass = 0;                  // kg; 0: fixed
  Mat3 inertia = Mat3::Identity();  // kg m^2, about the centre of mass; diagonal: the object's axes are principal
  double friction = 0.5;            // of the physics engine, against other objects
  bool loose() const { return mass > 0; }
};

// A part of an object as a hand meets it: the mesh of a fixed object that has one, else a piece.
struct MetPart {
  std::size_t object;
  Pose<double> at;  // in the object's axes
  std::variant<collision::Shape, std::shared_ptr<const collision::Tree>> body;
};

// Objects, and where among them a hand is meant to work. z is up.
struct Surroundings {
  std::string name = {};
  std::vector<Object> objects = {};
  Vec3 gravity = Vec3(0, 0, -9.81);  // m/s^2
  Vec3 focus = Vec3::Zero();         // m: the point that motions are placed about, on a surface
};

// Object after object; and where they are while the objects are at these poses.
std::vector<MetPart> met_parts(const Surroundings& surroundings);
std::vector<Pose<double>> met_poses(std::span<const MetPart> parts, PoseSpan objects);

// m, from the origin of a shape to its farthest point.
inline double reach_of(const collision::Shape& shape) { return shape.reach() + shape.radius(); }

// The parts of all objects in a world of colliders, to be placed object by object.
class Scenery {
 public:
  Scenery() = default;
  // Adds them to the world, where their objects are; as scenery, but for what `moves`.
  struct Role {
    collision::Filter filter = {};
    bool moves = false;
  };
  Scenery(collision::World& world, const Surroundings& surroundings, const std::function<Role(const Object&)>& role);

  void place(collision::World& world, std::size_t object, const Pose<double>& pose) const;
  int object_of(int collider) const;  // -1: none

 private:
  int first_ = 0;  // collider
  std::vector<MetPart> parts_ = {};
};

}  // namespace zwang::god
