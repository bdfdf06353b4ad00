#pragma once

#include <string>
#include <vector>

#include <zwang/bench/scenes/hand.h>
#include <zwang/collision/world.h>
#include <zwang/core/model/scene.h>
#include <zwang/experiments/god_hand/motion/hand_motion.h>

namespace zwang::god {

// God objects that are solved together, a cluster of section 5 of the paper: free bodies, the joints and limits among
// them, and the shapes that they are met by. A joint's first body is the one nearer to the root; joints close no loops.
struct GodObjects {
  static constexpr int most = 62;  // bodies; a filter has a bit for each, and two for objects

  Scene scene = {};
  std::vector<collision::Shape> shapes = {};    // by body
  std::vector<collision::Filter> filters = {};  // by body; all meet all until pass() is called

  // Both throw std::invalid_argument beyond `most` bodies.
  BodyId add(const Body& body, const collision::Shape& shape);
  void add_shape(const collision::Shape& shape);  // of the next body that has none
  // The two do not meet.
  void pass(BodyId a, BodyId b);
};

// Adds a hand: 96 unknowns, 70 joint rows, 40 limits written from `reach` [rad] before they are met on. The palm is a
// rounded box, the phalanxes are capsules. Bodies that touch while the hand is straight do not meet (those that share a
// joint, the roots of neighbouring fingers), nor do those of one finger, nor, unless it `meets` that, this hand and
// what was added before. Returns the palm.
BodyId add_hand(GodObjects& objects, const hand::Model& model, const Target& at, const std::string& prefix,
                double reach, bool meets = false);

}  // namespace zwang::god
