#pragma once

#include <zwang/core/model/scene_change.h>

namespace zwang {

// How the problem changes with its scene: changed() for the constraints there are here. Throws std::invalid_argument
// where the instance keeps no step.
Problem scene_change(const Instance& instance, const SceneChange& change);

}  // namespace zwang
