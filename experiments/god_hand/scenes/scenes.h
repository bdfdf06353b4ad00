#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include <zwang/experiments/god_hand/scenes/surroundings.h>

namespace zwang::god {

struct SceneEntry {
  std::string name;  // "simple", "engine", "detailed", "wall", "plate", "box", "pegs", ...
  std::string line;  // what is in it, for people
  std::function<Surroundings(const std::filesystem::path& parts)> make;  // parts: folder of real ones, or empty
};

// Every scene a hand can be simulated in, in the order of `./zwang simulate --help`.
std::span<const SceneEntry> scenes();

// A scene by name, or mesh files as fixed parts beside each other: "a.stl,b.obj@mm" (unit after '@'). Loose objects
// start clear of everything else. Throws std::invalid_argument with the nearest name, or for a scene that is not made
// of real parts; BadFile for a file, a missing one too.
Surroundings make_surroundings(const std::string& scene, const std::filesystem::path& parts);

// How much a hand meets.
struct SceneSize {
  std::size_t fixed = 0, loose = 0;  // objects
  std::size_t triangles = 0;         // of the meshes of fixed objects
};
SceneSize size_of(const Surroundings& surroundings);

}  // namespace zwang::god
