#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <zwang/bench/collision/drag.h>

namespace zwang {

// What the collision suite drags hands over.
struct DragScene {
  std::string name;               // "1M triangles, 20 parts"
  std::string parts;              // "real" or "procedural", and of what
  std::vector<DragOptions> runs;  // one run each
  int frames = 1000;              // of each run
  std::function<std::vector<Part>()> make;
};

// `data`: folder of the real parts; procedural ones stand in where it is absent. `cache`: of trees.
std::vector<DragScene> drag_scenes(const std::filesystem::path& data, const std::filesystem::path& cache);

// Parts side by side in rows, their tops at z = 0.
std::vector<Part> laid_out(const std::vector<std::shared_ptr<const collision::Tree>>& trees, double row);

}  // namespace zwang
