#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include <zwang/collision/broad_phase.h>
#include <zwang/collision/narrow_phase/approach.h>
#include <zwang/collision/narrow_phase/face_contacts.h>
#include <zwang/collision/narrow_phase/patch.h>

namespace zwang::collision {

// Two colliders are tested against each other when each one's mask has a bit of the other's group.
struct Filter {
  std::uint64_t group = 1, mask = ~std::uint64_t{0};

  bool meets(const Filter& other) const { return (group & other.mask) != 0 && (other.group & mask) != 0; }
};

// A contact or near contact: the nearest points of two colliders and their distance.
struct Touch {
  int a = 0, b = 0;             // colliders; a is a shape, b a mesh or a shape with a higher number
  std::uint32_t feature = 0;    // the (first) triangle of b's mesh, by the mesh's numbers; against a shape 0 to 6
  double gap = 0;               // m; negative where they overlap
  Vec3 normal = Vec3::Zero();   // unit, from b to a, world axes
  Vec3 point_a = Vec3::Zero();  // m, world, on a's surface
  Vec3 point_b = Vec3::Zero();  // m, world, on b's surface
};

// The motion of one collider over the step. All others are at rest.
struct Move {
  int collider = 0;
  Vec<double, 6> twist = Vec<double, 6>::Zero();  // m, rad; x(s) = retract(pose, s * twist)
  const Path* path = nullptr;                     // in place of the twist; lives until the query is over
};

struct TimeOfContact {
  double time = 1;       // of the step, in [0, 1]: until then there is no contact
  int a = -1, b = -1;    // the pair that comes into contact first; -1: none
  bool overlap = false;  // that pair overlaps at the start: time is 0
};

struct Margins {
  double stop = 1e-4;  // m: motions end between this gap and half of it (bodies that start nearer: stop_range)
};

// Meshes and shapes at their poses. Meshes are not tested against meshes. Queries allocate nothing once their lists
// have grown to what the scene needs; the same calls give the same bits.
class World {
 public:
  explicit World(Margins margins = {}) : margins_(margins) {}

  // Return the collider's number. Scenery (every mesh, and shapes added as such) is not tested against other scenery:
  // that is left to the physics engine. It may be placed and moved like anything else.
  int add(std::shared_ptr<const Tree> mesh, const Pose<double>& pose = {}, Filter filter = {});
  int add(const Shape& shape, const Pose<double>& pose = {}, Filter filter = {}, bool scenery = false);

  void place(int collider, const Pose<double>& pose);
  const Pose<double>& pose(int collider) const { return at(collider).pose; }
  const Shape* shape(int collider) const { return std::get_if<Shape>(&at(collider).body); }
  const Tree* mesh(int collider) const;
  int size() const { return static_cast<int>(colliders_.size()); }

  // Everything nearer than `activation` [m], in the order of a, b, and the leaves of b's tree. One entry for two shapes
  // (and up to six more at the corners of the area where two faces overlap), for a shape and a triangle, or for a shape
  // and a patch whose smallest gap one separating plane gives to a tenth of itself and of the stop distance, and never
  // too large; point_a, straight above the nearest vertex, may then lie beside the shape. A patch is up to 64
  // triangles, or slivers side by side across no more than a quarter of the shape's reach.
  // Valid until the next call.
  std::span<const Touch> touches(double activation);

  // The largest part of the step that all moves may make without a contact (Algorithm 1 of the paper): the minimum over
  // all pairs and triangles. Pose to commit: retract(pose, time * twist) or path(time). Reuses the pairs of the last
  // touches() when nothing was placed since and its distance was large enough. Throws std::invalid_argument for a
  // collider that does not exist or a twist that is not finite.
  TimeOfContact time_of_contact(std::span<const Move> moves);

 private:
  struct Collider {
    std::variant<Shape, std::shared_ptr<const Tree>> body;
    Pose<double> pose;
    Filter filter;
    bool scenery;
    Vec3 middle, half;  // m, of the box about it in its own axes
    double arm;         // m, from its origin to its farthest point
  };
  struct Candidate {
    std::uint32_t first, end;  // its triangles, in the tree's order
    std::size_t node;          // of slivers: whose subtree they are
    PlaneOver closest;         // b's axes; the core of a against them, or against the core of b
  };
  struct Pair {
    int a, b;
    std::size_t first, end;  // candidates
  };
  struct Found {
    std::vector<Pair> pairs;
    std::vector<Candidate> candidates;
  };

  const Collider& at(int c) const { return colliders_[static_cast<std::size_t>(c)]; }
  int add(Collider collider);
  static Eigen::AlignedBox3d box_of(const Collider& c);
  bool may_meet(int a, int b) const;
  BodyMotion body_motion(int collider) const;
  double travel(int collider) const;
  void collect(double activation, Found& found);
  void collect_pair(int a, int b, double activation, Found& found) const;
  void collect_mesh(const Tree& tree, const Region& region, double reach, bool swept,
                    std::vector<Candidate>& candidates) const;
  double safe_time(const Pair& pair, const Candidate& candidate, const RelativeMotion& motion, StopRange range,
                   double limit) const;

  Margins margins_;
  std::vector<Collider> colliders_;
  BroadPhase broad_phase_;
  std::vector<int> overlapping_;
  std::vector<const Move*> move_of_;  // of the present query, by collider
  Found near_, swept_;
  double near_reach_ = -1;          // m, activation distance of near_; -1: out of date
  std::vector<std::size_t> order_;  // of a pair's candidates
  std::vector<double> least_;       // m, by collider: its smallest gap at the start
  std::vector<Touch> touches_;
  FaceContacts face_contacts_;
};

}  // namespace zwang::collision
