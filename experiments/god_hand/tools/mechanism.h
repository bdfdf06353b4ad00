#pragma once

#include <array>
#include <filesystem>

#include <zwang/experiments/god_hand/tools/tool.h>

namespace zwang::god {

// A mechanism from a file: a scene file (.json, docs/scene-files.md), or an MJCF or URDF model (.xml, .mjcf, .urdf), as
// docs/god-hand/scenes.md says, "Other god objects". The axes of the file are the palm's, or "FILE@x-z" says which of them go
// along the fingers and out of the back. Throws BadFile, one line: the file, where in it, what was expected.
bool is_mechanism(const std::string& name);
Tool read_mechanism(const std::string& name);
// The file of such a name, and the rest of it: "@x-z" or nothing.
std::array<std::string, 2> parts_of_name(const std::string& name);

// Both with the palm's axes along those of the file.
Tool of_scene_file(const std::filesystem::path& file);
Tool of_model(const std::filesystem::path& file);  // MuJoCo reads it

// A hinge of a tool that is being made: its joint's second body turns, and all that hang on it.
struct HingeDrive {
  std::string name;
  BodyId body;
  double scale;     // rad per rad, about the axis of the joint's first body
  double rest = 0;  // as Tool::Drive
};
// What is left once bodies, shapes, joints and limits are there: joints are closed, hinges get their drives, and bodies
// that are joined or overlap at rest pass each other.
void complete(Tool& tool, const std::vector<HingeDrive>& hinges);

}  // namespace zwang::god
