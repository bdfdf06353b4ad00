#include <zwang/experiments/god_hand/hand/god_objects.h>

#include <stdexcept>

#include <zwang/experiments/god_hand/hand/hand_shapes.h>

namespace zwang::god {
using collision::Shape;

void GodObjects::add_shape(const Shape& shape) {
  if (static_cast<int>(shapes.size()) == most)
    throw std::invalid_argument("a cluster has at most " + std::to_string(most) + " god objects");
  filters.push_back({std::uint64_t{1} << shapes.size(), ~std::uint64_t{0}});
  shapes.push_back(shape);
}

BodyId GodObjects::add(const Body& body, const Shape& shape) {
  add_shape(shape);
  return scene.add(body);
}

void GodObjects::pass(BodyId a, BodyId b) {
  auto &of_a = filters[at(a)], &of_b = filters[at(b)];
  of_a.mask &= ~of_b.group;
  of_b.mask &= ~of_a.group;
}

BodyId add_hand(GodObjects& objects, const hand::Model& model, const Target& at, const std::string& prefix,
                double reach, bool meets) {
  const BodyId palm =
      hand::add(objects.scene, hand::forward_kinematics(at.palm, at.angles, model), prefix, model, reach);
  const std::vector<Shape> parts = hand::shapes(model);
  for (const Shape& shape : parts) objects.add_shape(shape);
  for (BodyId a = palm; a < palm + hand::bodies && !meets; ++a)
    for (BodyId b = 0; b < palm; ++b) objects.pass(a, b);
  for (BodyId a = 1; a < hand::bodies; ++a)
    for (BodyId b = 1; b < a; ++b)
      if ((a - 1) / 3 == (b - 1) / 3) objects.pass(palm + a, palm + b);
  const hand::Poses straight = hand::forward_kinematics({}, {}, model);
  collision::World world;
  for (std::size_t b = 0; b < parts.size(); ++b) world.add(parts[b], straight[b]);
  for (const collision::Touch& touch : world.touches(hand::touching)) objects.pass(palm + touch.a, palm + touch.b);
  return palm;
}

}  // namespace zwang::god
