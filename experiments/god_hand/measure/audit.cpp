#include <zwang/experiments/god_hand/measure/audit.h>

#include <zwang/bench/collision/witness.h>

namespace zwang::god {
namespace {

std::vector<std::shared_ptr<const collision::Tree>> met_meshes(const Surroundings& surroundings) {
  std::vector<std::shared_ptr<const collision::Tree>> meshes;
  for (const Object& object : surroundings.objects)
    if (object.mesh && !object.loose()) meshes.push_back(object.mesh);
  return meshes;
}

}  // namespace

struct Audit::Scene {
  const Surroundings& surroundings;
  std::span<const std::vector<collision::Shape>> hands;
  Witness witness;

  bool overlaps(const collision::Shape& shape, const Pose<double>& pose, std::span<const Pose<double>> loose) const;
  bool meets_other_hand(std::size_t hand, std::size_t body, std::span<const Pose<double>> god) const;
};

// Fixed objects with a mesh are met by it, all others by their pieces.
bool Audit::Scene::overlaps(const collision::Shape& shape, const Pose<double>& pose,
                            std::span<const Pose<double>> loose) const {
  std::size_t mesh = 0, moved = 0;
  for (const Object& object : surroundings.objects) {
    const Pose<double>& at = object.loose() ? loose[moved++] : object.pose;
    if (object.mesh && !object.loose()) {
      if (witness.overlaps(shape, pose, mesh++, at)) return true;
      continue;
    }
    for (const Object::Piece& piece : object.pieces)
      if (witness.overlaps(shape, pose, piece.shape, {at * piece.at.position, at.rotation * piece.at.rotation}))
        return true;
  }
  return false;
}

// Asked once for each pair, by the later hand.
bool Audit::Scene::meets_other_hand(std::size_t hand, std::size_t body, std::span<const Pose<double>> god) const {
  std::size_t first = 0;
  for (std::size_t h = 0; h < hand; ++h) first += hands[h].size();
  std::size_t other = 0;
  for (std::size_t h = 0; h < hand; ++h)
    for (const collision::Shape& shape : hands[h])
      if (witness.overlaps(hands[hand][body], god[first + body], shape, god[other++])) return true;
  return false;
}

Audit::Audit(const Surroundings& surroundings, std::span<const std::vector<collision::Shape>> hands)
    : scene_(new Scene{surroundings, hands, Witness(met_meshes(surroundings))}) {}
Audit::~Audit() = default;

void Audit::look(const Frame& frame) {
  std::size_t at = 0;
  for (std::size_t hand = 0; hand < scene_->hands.size(); ++hand)
    for (std::size_t body = 0; body < scene_->hands[hand].size(); ++body, ++at) {
      ++looked_;
      crossed_ += scene_->meets_other_hand(hand, body, frame.god);
      if (!scene_->overlaps(scene_->hands[hand][body], frame.god[at], frame.loose)) continue;
      ++found_;
      if (first_ < 0) first_ = frame.number;
    }
}

}  // namespace zwang::god
