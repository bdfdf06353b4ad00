#pragma once

#include <vector>

#include "bench/scenes/hand.h"
#include "collision/shape.h"

namespace zwang::god {

// What a hand is made of where it meets objects, in the order and the axes of hand::Poses: the palm a box rounded by
// 6 mm (by half its smallest width where that is less), the phalanxes capsules whose caps are centred on their joints.
std::vector<collision::Shape> hand_shapes(const hand::Model& model);

}  // namespace zwang::god
