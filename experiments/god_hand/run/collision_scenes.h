#pragma once

#include <filesystem>
#include <vector>

#include <zwang/bench/collision/moving_hand.h>

namespace zwang::god {

// The god hand for the collision suite: the shipped simulation in the scenes of `./zwang simulate` and in some that are
// hard for collision queries. `data`: real parts; procedural ones stand in where they are absent.
std::vector<HandScene> collision_scenes(const std::filesystem::path& data);

}  // namespace zwang::god
