#pragma once

#include <vector>

#include <zwang/bench/scenes/hand.h>
#include <zwang/collision/shape.h>

namespace zwang::hand {

// What a hand is made of where it meets objects, in the order and the axes of Poses: the palm a box rounded by 6 mm (by
// half its smallest width where that is less), the phalanxes capsules whose caps are centred on their joints.
std::vector<collision::Shape> shapes(const Model& model);

// m: a body at most this far from something touches it. Contact rows keep 0.2 mm, and sweeps stop between 0.05 and
// 0.1 mm: whatever rests on a surface or slides along it is well within this.
inline constexpr double touching = 5e-4;

}  // namespace zwang::hand
