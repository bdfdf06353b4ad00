#pragma once

#include <memory>
#include <span>

#include <zwang/collision/shape.h>
#include <zwang/collision/tree.h>

namespace zwang {

// FCL's own collision query (libccd) on its own tree (OBBRSS) of the same triangles: an independent witness.
class Witness {
 public:
  explicit Witness(std::span<const std::shared_ptr<const collision::Tree>> meshes);
  ~Witness();

  // Does the shape at `pose` overlap the mesh at `of_mesh`? A rounded box is looked at as the three boxes and twelve
  // capsules that it is the union of; of a hull, the capsules between its corners.
  bool overlaps(const collision::Shape& shape, const Pose<double>& pose, std::size_t mesh,
                const Pose<double>& of_mesh) const;
  // Do two shapes overlap? What a hull has beyond those capsules, its faces moved out by the radius, counts too. Shapes
  // are known by their addresses: they outlive the witness, unchanged.
  bool overlaps(const collision::Shape& shape, const Pose<double>& pose, const collision::Shape& other,
                const Pose<double>& of_other) const;

  // The plainest continuous query that FCL's discrete ones allow, as a rival: step by (distance - stop / 2) over the
  // fastest point's speed until the distance is at most `stop`. fcl::distance at tolerance 1e-9. Spheres and capsules.
  double advance(const collision::Shape& shape, const Pose<double>& pose, const Vec<double, 6>& twist, std::size_t mesh,
                 double stop) const;

 private:
  struct Models;
  std::unique_ptr<Models> models_;
};

}  // namespace zwang
