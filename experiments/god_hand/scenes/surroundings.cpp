#include <zwang/experiments/god_hand/scenes/surroundings.h>

namespace zwang::god {

std::vector<MetPart> met_parts(const Surroundings& surroundings) {
  std::vector<MetPart> parts;
  for (std::size_t k = 0; k < surroundings.objects.size(); ++k) {
    const Object& object = surroundings.objects[k];
    if (object.mesh && !object.loose())
      parts.push_back({k, {}, object.mesh});
    else
      for (const Object::Piece& piece : object.pieces) parts.push_back({k, piece.at, piece.shape});
  }
  return parts;
}

std::vector<Pose<double>> met_poses(std::span<const MetPart> parts, PoseSpan objects) {
  return mapped(parts, [&](const MetPart& part) { return placed(objects[part.object], part.at); });
}

Scenery::Scenery(collision::World& world, const Surroundings& surroundings,
                 const std::function<Role(const Object&)>& role)
    : first_(world.size()), parts_(met_parts(surroundings)) {
  for (const MetPart& part : parts_) {
    const Object& object = surroundings.objects[part.object];
    const Pose<double> pose = placed(object.pose, part.at);
    const auto [filter, moves] = role(object);
    if (const auto* shape = std::get_if<collision::Shape>(&part.body))
      world.add(*shape, pose, filter, !moves);
    else
      world.add(std::get<std::shared_ptr<const collision::Tree>>(part.body), pose, filter);
  }
}

void Scenery::place(collision::World& world, std::size_t object, const Pose<double>& pose) const {
  for (std::size_t k = 0; k < parts_.size(); ++k)
    if (parts_[k].object == object) world.place(first_ + static_cast<int>(k), placed(pose, parts_[k].at));
}

int Scenery::object_of(int collider) const {
  return collider < first_ ? -1 : static_cast<int>(parts_[at(collider - first_)].object);
}

}  // namespace zwang::god
