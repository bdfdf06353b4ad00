#pragma once

#include <filesystem>

#include <zwang/experiments/god_hand/scenes/surroundings.h>

// The scenes that are large, each in a file of its own kind.
namespace zwang::god {

Surroundings simple_scene();
Surroundings engine_scene();
Surroundings detailed_scene();

// Loose things of an engine bay: a cap, a relay, and a bolt standing on its head.
void add_small_parts(Surroundings& s, const Vec3& on);
void add_box_and_can(Surroundings& s, const Vec3& box, const Vec3& can);

// Of real parts, found in the folder by their file names. Throw BadFile.
Surroundings real_simple_scene(const std::filesystem::path& parts);
Surroundings real_engine_scene(const std::filesystem::path& parts);

// Files "a.stl,b.obj@mm" side by side, their tops at z = 0. Throws BadFile.
Surroundings files_scene(const std::string& files);

}  // namespace zwang::god
