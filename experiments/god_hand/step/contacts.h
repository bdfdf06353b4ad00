#pragma once

#include <span>
#include <vector>

#include <zwang/collision/manifold.h>
#include <zwang/collision/nearest.h>
#include <zwang/collision/world.h>
#include <zwang/experiments/god_hand/hand/god_objects.h>
#include <zwang/experiments/god_hand/scenes/surroundings.h>

namespace zwang::god {

// What the god objects of a cluster are near to, what of it becomes contact rows, and how far they may go.
//
// collision::World gives one touch for a shape and a triangle, or for a shape and a shape. If each of them became a
// row, a hand would be held back where nothing is in its way, and tremble on the spot:
// - The triangles around a finger tip touch it at their edges, with normals that lean; a tip that slides over a flat
//   floor runs into the edge of the triangle ahead.
// - A palm flat on a table touches each triangle anywhere in the patch they share. It tips over those points, and in
// the
//   next frame they are on the other side.
// So rows are written for spheres that are part of a shape. The corners of its core, with its radius, are where a flat
// contact ends; every point of the core is a mean of them, so that their rows imply those of all touches with the same
// plane. Against a mesh each sphere has the nearest point of all, then the nearest that the first one's plane does not
// hide, and so on. Of the touches that are left, those that the manifold keeps are each replaced by a sphere at that
// point of the core, unless there is a row for that one: of many triangles the same point of the core is nearest, and a
// row that is there several times leaves open which of them carries. Sweeps do not use any of this: they use the
// shapes.
class Contacts {
 public:
  Contacts(const GodObjects& objects, const Surroundings& surroundings);

  void place(BodyId body, const Pose<double>& pose) { world_.place(body, pose); }
  void place_object(std::size_t object, const Pose<double>& pose) { scenery_.place(world_, object, pose); }

  // Of a touch, a is a god object, b a god object or a collider of object_of().
  struct Row {
    collision::Touch touch;
    std::uint64_t key;  // names the touch over frames, never 0
    double lift;        // m: that much more than the others keeps it from being a combination of them
  };
  // Looks for everything within a distance [m]. What becomes rows: a few, that complete() adds to; all that it could
  // add, too; or every touch as it comes, corners or not.
  enum class Choice { few, all, raw };
  void find_rows(double activation, Choice choice);
  std::span<const Row> rows() const { return rows_; }
  std::size_t raw() const { return raw_; }
  // Of each pair, gives back the left out row that a motion (m, rad; by god object) violates most: how many. Rows keep
  // `gap` [m]; without `push`, what they have of it.
  int complete(std::span<const Vec<double, 6>> motion, double gap, bool push);

  int object_of(int collider) const { return scenery_.object_of(collider); }  // -1: a god object

  // The part of the way that all god objects may go (m, rad; by god object).
  double time_of_contact(std::span<const Vec<double, 6>> screws);
  // The smallest gap to anything or between two god objects [m]; `reach` where there is none below that.
  double gap(double reach);

 private:
  struct Corner {
    Vec3 at;         // m, in the god object's axes
    BodyId said_by;  // whose rows say it
  };
  using Touches = std::span<const collision::Touch>;
  void choose_corners(const GodObjects& objects);
  void meet(Touches touches, double activation);
  void meet_mesh(int a, std::size_t corner, int b, double activation);
  void meet_shape(int a, int b, double activation);
  void find_planes(int a, int b, std::size_t first_row, double activation);
  void make_row(std::size_t left);
  void add_kept(std::size_t from, bool repeat);
  bool is_said(const collision::Touch& touch) const;
  void add_row(const Row& row);

  collision::World world_;
  collision::Manifold manifold_;
  Scenery scenery_;
  std::vector<std::vector<Corner>> corners_;  // of the cores, by god object
  std::vector<collision::Touch> left_;        // that corners do not imply
  std::vector<collision::Touch> as_row_;      // the same, as they are or would be rows, where made_
  std::vector<char> made_;
  struct Foot {  // of a sphere on a mesh
    int a = -1, b = -1;
    Vec3 center = Vec3::Zero();
    bool clear = false;  // the sphere's centre is not on the mesh
    Vec3 point = Vec3::Zero();
  };
  Foot foot_;  // the last that was looked for: many slivers touch the same end of a finger
  std::vector<Row> rows_;
  std::vector<collision::Plane> planes_;  // m, world; of the pair at hand
  std::size_t raw_ = 0;
  std::vector<Vec<double, 6>> motion_;  // by collider
  std::vector<collision::Move> moves_;
};

}  // namespace zwang::god
