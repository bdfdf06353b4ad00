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

int add_part(collision::World& world, const Surroundings& surroundings, const MetPart& part, collision::Filter filter) {
  const Pose<double> pose = placed(surroundings.objects[part.object].pose, part.at);
  if (const auto* shape = std::get_if<collision::Shape>(&part.body)) return world.add(*shape, pose, filter, true);
  return world.add(std::get<std::shared_ptr<const collision::Tree>>(part.body), pose, filter);
}

}  // namespace zwang::god
