#include "experiments/god/god_objects.h"

#include <stdexcept>

#include "experiments/god/hand_shapes.h"

namespace zwang::god {
namespace {

using collision::Shape;

// Pairs that come nearer than `room` [m] to each other in the straight hand.
std::vector<std::pair<int, int>> touching_while_straight(std::span<const Shape> shapes, const hand::Poses& straight,
                                                         double room) {
  collision::World world;
  for (std::size_t b = 0; b < straight.size(); ++b) world.add(shapes[b], straight[b]);
  std::vector<std::pair<int, int>> pairs;
  for (const collision::Touch& t : world.touches(room)) pairs.emplace_back(t.a, t.b);
  return pairs;
}

}  // namespace

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
  auto &of_a = filters[static_cast<std::size_t>(a)], &of_b = filters[static_cast<std::size_t>(b)];
  of_a.mask &= ~of_b.group;
  of_b.mask &= ~of_a.group;
}

BodyId add_hand(GodObjects& objects, const hand::Model& model, const Target& at, const std::string& prefix,
                double reach) {
  const BodyId palm = hand::add(objects.scene, hand::assemble(at.palm, at.angles, model), prefix, model, reach);
  for (const Shape& shape : hand_shapes(model)) objects.add_shape(shape);
  for (BodyId a = palm; a < palm + hand::bodies; ++a) {
    for (BodyId b = 0; b < palm; ++b) objects.pass(a, b);
    for (BodyId b = palm + 1; b < a; ++b)
      if ((a - palm - 1) / 3 == (b - palm - 1) / 3) objects.pass(a, b);
  }
  const std::span<const Shape> shapes = std::span(objects.shapes).subspan(static_cast<std::size_t>(palm));
  for (const auto& [a, b] : touching_while_straight(shapes, hand::assemble({}, {}, model), 5e-4))
    objects.pass(palm + a, palm + b);
  return palm;
}

}  // namespace zwang::god
