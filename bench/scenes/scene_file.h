#pragma once

#include <filesystem>

#include <zwang/bench/scenes/physical.h>

namespace zwang {

// A scene written down as JSON (docs/scene-files.md, docs/scene.schema.json): bodies, shapes, joints, limits, contacts,
// motion. Its problem is assembled as every scene's is. Throws BadFile with line and member.
Instance read_scene_file(const std::filesystem::path& file);

}  // namespace zwang
