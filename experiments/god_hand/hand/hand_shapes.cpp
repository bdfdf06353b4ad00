#include <zwang/experiments/god_hand/hand/hand_shapes.h>

#include <algorithm>

#include <zwang/collision/world.h>

namespace zwang::hand {

using collision::Shape;

std::vector<Shape> shapes(const Model& model) {
  const Vec3& widths = model.palm_widths;
  std::vector<Shape> out = {Shape::rounded_box(widths, std::min(0.006, widths.minCoeff() / 2))};
  for (int body = 1; body < bodies; ++body) {
    const Phalanx bone = model.phalanx(body);
    out.push_back(Shape::capsule(bone.length, bone.radius));
  }
  return out;
}

std::vector<std::pair<int, int>> passing(const Model& model) {
  constexpr double room = 5e-4;  // m
  std::vector<std::pair<int, int>> pairs;
  for (int a = 1; a < bodies; ++a)
    for (int b = 1; b < a; ++b)
      if ((a - 1) / 3 == (b - 1) / 3) pairs.emplace_back(a, b);
  const std::vector<Shape> parts = shapes(model);
  const Poses straight = forward_kinematics({}, {}, model);
  collision::World world;
  for (std::size_t b = 0; b < parts.size(); ++b) world.add(parts[b], straight[b]);
  for (const collision::Touch& t : world.touches(room)) pairs.emplace_back(t.a, t.b);
  return pairs;
}

}  // namespace zwang::hand
