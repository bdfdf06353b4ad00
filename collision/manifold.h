#pragma once

#include <span>
#include <vector>

#include <zwang/collision/world.h>

namespace zwang::collision {

// Reduces the touches to a few, and adds back those that a solution turns out to violate. Works on indices into the
// list of touches. No allocation once its lists have grown.
class Manifold {
 public:
  // Touches of a body on the same partner whose normals are within `cone` of each other form a cluster, of which the
  // closest point and the ones farthest apart are kept, `per_cluster` at most.
  static constexpr double cone = 0.26179938779914941;  // rad (15 degrees)
  static constexpr int clusters = 8;                   // per collider a; those with the smallest gaps
  explicit Manifold(int per_cluster = 4) : per_cluster_(per_cluster) {}

  // Chooses among `touches` (of World::touches, whose order it relies on: grouped by a).
  // With `all` every touch is kept.
  void reduce(std::span<const Touch> touches, bool all = false);
  std::span<const std::uint32_t> kept() const { return kept_; }
  // Not to be added: something else says what this touch says.
  void pass_over(std::uint32_t touch) { is_kept_[touch] = 1; }

  // Lazy completion, after a solve with the kept touches: every touch must have a gap of at least `target` after the
  // motion, to first order; without `push`, of its present gap where that is less. Of each pair of colliders, adds the
  // touch that is violated most, if by more than `tolerance` [m]. Returns how many were added to kept(); 0: the result
  // is that of all touches, to this tolerance. twist: the motion of each collider [m; rad, world axes], by its number.
  int complete(std::span<const Touch> touches, const World& world, std::span<const Vec<double, 6>> twist, double target,
               double tolerance, bool push = true);

 private:
  void reduce_one(std::span<const Touch> touches, std::uint32_t first, std::uint32_t end);
  void keep_corners(std::span<const Touch> touches, std::uint32_t closest);
  void keep(std::uint32_t touch);

  int per_cluster_;
  std::vector<std::uint32_t> kept_, left_, members_;
  std::vector<char> is_kept_;
};

}  // namespace zwang::collision
