#include "experiments/god/hand_shapes.h"

#include <algorithm>

namespace zwang::god {

std::vector<collision::Shape> hand_shapes(const hand::Model& model) {
  const Vec3& widths = model.palm_widths;
  std::vector<collision::Shape> shapes = {
      collision::Shape::rounded_box(widths, std::min(0.006, widths.minCoeff() / 2))};
  for (int body = 1; body < hand::bodies; ++body) {
    const hand::Phalanx bone = model.phalanx(body);
    shapes.push_back(collision::Shape::capsule(bone.length, bone.radius));
  }
  return shapes;
}

}  // namespace zwang::god
