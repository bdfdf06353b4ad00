#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <zwang/core/problem/instance.h>

namespace zwang {

// One parameter of a scene.
struct Knob {
  std::string name;
  double value;      // the default
  double low, high;  // accepted range, inclusive
  bool integer;
  std::string help;  // with the unit
};

using Knobs = std::map<std::string, double>;

// One line of `./zwang scenes`: a seeded, parametric generator.
struct SceneEntry {
  std::string name;
  std::string family;  // groups problems in charts; usually the name
  std::string line;
  std::string sweep = {};  // the knob that scaling and break-point charts use, or ""; it runs from benign to hard
  std::vector<Knob> knobs;
  std::function<Instance(const Knobs&)> make;  // all knobs present and in range
};

// Every scene there is. Explicit: a new one is an entry of catalog.json and the name of its function in catalog.cpp.
std::span<const SceneEntry> scenes();

// One more, of a host program: behind the others. Before the first run: spans of scenes() taken earlier are void then.
// Throws std::invalid_argument where its name is taken.
void add_scene(SceneEntry entry);
const SceneEntry* find_scene(std::string_view name);

// "tower(boxes=10,100),hand(contacts=64,seed=1..5)" -> every combination, named "tower(boxes=10)" and so on.
// "crane.json" is a scene file (scene_file.h). `seed` is the default of every knob of that name; `mu`, where given,
// that of the scenes whose text does not say one, as if it did. Throws std::invalid_argument with the nearest name, or
// the knob's range.
std::vector<Instance> make_scenes(std::string_view text, std::uint64_t seed = 1, std::optional<double> mu = {});

}  // namespace zwang
