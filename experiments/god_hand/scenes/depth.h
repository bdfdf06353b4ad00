#pragma once

#include <span>
#include <vector>

#include <zwang/bench/scenes/hand.h>
#include <zwang/experiments/god_hand/scenes/surroundings.h>

namespace zwang::god {

// A ball within a god object.
struct Ball {
  int body;  // of hand::Poses
  Vec3 at;   // m, its centre, in the body's axes
  double radius;
};

// The balls a hand is measured with: along the phalanxes' cores their capsules' own, in the palm the largest that fit
// into the box, and those of its corners.
std::vector<Ball> balls(const hand::Model& model);

// How deep a hand is inside the objects, for reports and for placing motions. The depth of a ball is how far it would
// have to move to be clear: exact against convex pieces. A point is inside a mesh when rays in six directions all see
// the surface wind around it: closed parts that overlap count as one, and a sheet has no inside (being pierced by it
// counts as the depth of the ball that is).
class Depth {
 public:
  explicit Depth(const Surroundings& surroundings);
  ~Depth();

  // m, from a point to an object's surface, negative inside; where that is more than `reach` >= 0, reach. The
  // objects stand as in the surroundings, or at `poses` (one per object).
  double distance(const Vec3& point, std::size_t object, double reach, PoseSpan poses = {}) const;
  double distance(const Vec3& point, double reach) const;  // to all, as in the surroundings

  // m, of the deepest ball; negative: all are clear by that, -reach: by at least that.
  double of(const hand::Poses& hand, std::span<const Ball> balls, double reach = 0, PoseSpan poses = {}) const;

 private:
  struct Volume;
  std::vector<Volume> volumes_;
};

}  // namespace zwang::god
