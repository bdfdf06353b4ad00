#pragma once

#include <zwang/collision/mesh_file.h>
#include <zwang/collision/tree.h>

namespace zwang::collision {

// A mesh ready for queries.
struct LoadedTree {
  Tree tree = {};
  MeshReport report = {};
  bool cached = false;  // the tree came from the cache; nothing was parsed
};

// read_mesh and Tree, in a child process (core/process/isolated.h) with time and memory in proportion to the file's
// size. With options.cache the tree is kept there under the SHA-256 of the file's bytes, the unit, the weld
// distance and the kind of file, and taken from there the next time. A damaged cache file is replaced. Throws BadFile.
LoadedTree load_tree(const std::filesystem::path& file, const MeshFileOptions& options = {});

// The folder of trees kept between runs: $XDG_CACHE_HOME/zwang/trees, or $HOME/.cache/zwang/trees; empty without
// either.
std::filesystem::path tree_cache();

}  // namespace zwang::collision
