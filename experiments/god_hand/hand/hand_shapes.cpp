#include <zwang/experiments/god_hand/hand/hand_shapes.h>

#include <algorithm>

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

}  // namespace zwang::hand
