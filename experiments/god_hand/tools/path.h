#pragma once

#include <filesystem>
#include <optional>

#include <zwang/experiments/god_hand/tools/tool.h>

namespace zwang::god {

// The path of a tool from a table: time,x,y,z,qw,qx,qy,qz; perhaps close [rad], the angle that closes a gripper; and
// columns with the names of hinges [rad], which set these. None: the file is not such a table. Throws BadFile.
std::optional<HandMotion> read_path(const std::filesystem::path& file, const Tool& tool);

}  // namespace zwang::god
