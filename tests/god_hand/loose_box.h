#pragma once

#include <zwang/experiments/god_hand/scenes/surroundings.h>

namespace zwang::god {

// A box of 60 mm and 0.2 kg.
inline Object loose_box(const Vec3& at, double width = 0.06) {
  const double mass = 0.2;
  return {.name = "box",
          .pieces = {{collision::Shape::rounded_box(Vec3::Constant(width), 0.002)}},
          .pose = {at, Mat3::Identity()},
          .mass = mass,
          .inertia = mass * width * width / 6 * Mat3::Identity()};
}

inline Object fixed_block(const Vec3& at, const Vec3& widths) {
  return {.name = "block", .pieces = {{collision::Shape::rounded_box(widths, 0.002)}}, .pose = {at, Mat3::Identity()}};
}

}  // namespace zwang::god
