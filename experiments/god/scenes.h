#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "experiments/god/surroundings.h"

namespace zwang::god {

struct SceneEntry {
  std::string name;  // "simple", "engine", "detailed", "wall", "plate", "box", "pegs", ...
  std::string line;  // what is in it, for people
  std::function<Surroundings(const std::filesystem::path& parts)> make;  // parts: folder of real ones, or empty
};

// Every scene a hand can be simulated in, in the order of `./zwang simulate --help`.
std::span<const SceneEntry> scenes();

// A scene by name, or mesh files as fixed parts beside each other: "a.stl,b.obj@mm" (unit after '@'). Throws
// std::invalid_argument with the nearest name, BadFile for a file.
Surroundings make_surroundings(const std::string& scene, const std::filesystem::path& parts);

}  // namespace zwang::god
