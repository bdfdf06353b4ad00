#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <zwang/experiments/god_hand/scenes/surroundings.h>

namespace zwang::god {

// Every scene a hand can be simulated in, in the order of `./zwang simulate --help`: its name, and one line on what is
// in it.
std::vector<std::pair<std::string, std::string>> scenes();

// A scene by name, or mesh files as fixed parts beside each other: "a.stl,b.obj@mm" (unit after '@'). `parts`: a folder
// of real ones that it is made of, or empty. Loose objects start clear of everything else. Throws std::invalid_argument
// with the nearest name, or for a scene that is not made of real parts; BadFile for a file, a missing one too.
Surroundings make_surroundings(const std::string& scene, const std::filesystem::path& parts);

// How much a hand meets.
struct SceneSize {
  std::size_t fixed = 0, loose = 0;  // objects
  std::size_t triangles = 0;         // of the meshes of fixed objects
};
SceneSize size_of(const Surroundings& surroundings);

}  // namespace zwang::god
