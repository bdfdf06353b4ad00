#include <zwang/bench/collision/audit.h>

namespace zwang {

using collision::Shape;
using TreePointer = std::shared_ptr<const collision::Tree>;

static std::vector<TreePointer> meshes_of(std::span<const Obstacle> obstacles) {
  std::vector<TreePointer> meshes;
  for (const Obstacle& obstacle : obstacles)
    if (const auto* mesh = std::get_if<TreePointer>(&obstacle)) meshes.push_back(*mesh);
  return meshes;
}

Audit::Audit(std::vector<std::vector<Shape>> hands, std::vector<Obstacle> obstacles)
    : hands_(std::move(hands)), obstacles_(std::move(obstacles)), witness_(meshes_of(obstacles_)) {}

bool Audit::overlaps(const Shape& shape, const Pose<double>& pose, PoseSpan obstacles) const {
  std::size_t mesh = 0;
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    const Shape* other = std::get_if<Shape>(&obstacles_[k]);
    if (other ? witness_.overlaps(shape, pose, *other, obstacles[k])
              : witness_.overlaps(shape, pose, mesh++, obstacles[k]))
      return true;
  }
  return false;
}

bool Audit::crosses(std::size_t hand, const Shape& shape, const Pose<double>& pose, PoseSpan bodies) const {
  std::size_t at = 0;
  for (std::size_t h = 0; h < hand; ++h)
    for (const Shape& other : hands_[h])
      if (witness_.overlaps(shape, pose, other, bodies[at++])) return true;
  return false;
}

long Audit::check(PoseSpan bodies, PoseSpan obstacles) {
  const long before = found_;
  std::size_t at = 0;
  for (std::size_t hand = 0; hand < hands_.size(); ++hand)
    for (const Shape& shape : hands_[hand]) {
      const Pose<double>& pose = bodies[at++];
      ++checked_;
      crossed_ += crosses(hand, shape, pose, bodies);
      found_ += overlaps(shape, pose, obstacles);
    }
  return found_ - before;
}

}  // namespace zwang
