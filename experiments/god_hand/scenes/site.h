#pragma once

#include <array>
#include <functional>
#include <vector>

#include <zwang/experiments/god_hand/scenes/depth.h>
#include <zwang/experiments/god_hand/scenes/surroundings.h>

namespace zwang::god {

// Where made motions go on: the focus of the surroundings, the way out of the surface there, the object it belongs to.
struct Site {
  const Surroundings& about;
  Depth depth;
  std::vector<Ball> of_hand = balls(hand::standard());
  Vec3 focus, out, along, aside;  // m; unit vectors, aside = along x out
  std::size_t object = 0;

  explicit Site(const Surroundings& surroundings);

  // The rotation of a palm whose fingers and back look these ways.
  static Mat3 axes(const Vec3& fingers, const Vec3& back);

  // The palm parallel to the surface, its underside at this height [m] over it.
  Pose<double> flat(double height, double forth = 0, double sideways = 0) const;

  bool clear(const Pose<double>& palm, const hand::Angles& angles, const hand::Model& model) const;  // by 10 mm

  // The first height [m] from `least` on at which place(height) is clear of everything. Throws std::invalid_argument.
  double clear_height(double least, const std::function<Pose<double>(double)>& place, const hand::Angles& angles = {},
                      const hand::Model& model = hand::standard()) const;

  // How far one may go from a point of the focus' object before leaving it, m; at most 0.15.
  double solid_way(const Vec3& from, const Vec3& axis) const;

  // From where the focus' object begins to where it ends along an axis, m; and the middle of that on all axes.
  std::array<double, 2> extent(const Vec3& axis) const;
  Vec3 middle() const;
};

}  // namespace zwang::god
