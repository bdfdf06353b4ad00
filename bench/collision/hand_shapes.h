#pragma once

#include <utility>
#include <vector>

#include <zwang/bench/scenes/hand.h>
#include <zwang/collision/shape.h>

namespace zwang::hand {

// What a hand is made of where it meets objects, in the order and the axes of Poses: the palm a box rounded by 6 mm (by
// half its smallest width where that is less), the phalanxes capsules whose caps are centred on their joints.
std::vector<collision::Shape> shapes(const Model& model);

// A body nearer than this to something touches it.
inline constexpr double touching = 5e-4;  // m

// Its bodies that do not meet each other: those of one finger, and those that touch while the hand is straight (that
// share a joint, the roots of neighbouring fingers).
std::vector<std::pair<int, int>> passing(const Model& model);

}  // namespace zwang::hand
