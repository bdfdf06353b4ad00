#include <zwang/bench/scenes/catalog.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/bench/scenes/families.h>
#include <zwang/bench/scenes/friction/families.h>
#include <zwang/bench/scenes/friction/friction.h>
#include <zwang/core/files/embedded.h>

ZWANG_EMBEDDED(catalog_json, ZWANG_CATALOG)

namespace zwang {
namespace {

using Make = std::function<Instance(const Knobs&)>;

std::map<std::string, Make> makers() {
  std::map<std::string, Make> all{
#define SCENE(name, make) {#name, make},
#include <zwang/bench/scenes/scenes.def>
#undef SCENE
  };
  for (auto& [name, make] : friction_families()) all.emplace(name, std::move(make));
  return all;
}

// A scene that leaves its contacts as they are gets friction as a matrix does (friction/friction.h).
Make with_friction_of_knob(Make make) {
  return [make = std::move(make)](const Knobs& knobs) {
    Instance made = make(knobs);
    const double mu = friction_of(knobs);
    return mu > 0 && !made.problem.has_tangents() ? with_friction(made, mu) : made;
  };
}

// Of catalog.json. Charts sweep a scene's first knob, where that counts something. "mu" is the default of its knob: 0
// but where friction decides, so that it is there unless it is asked away; a scene without contacts has none.
SceneEntry entry_of(const nlohmann::json& j, Make make) {
  SceneEntry entry{.name = j.at("name"),
                   .family = j.value("family", entry.name),
                   .line = j.at("line"),
                   .knobs = {},
                   .make = std::move(make)};
  for (const nlohmann::json& k : j.at("knobs"))
    entry.knobs.push_back({k.at(0), k.at(2), k.at(3), k.at(4), k.at(1) == "integer", k.at(5)});
  if (!entry.knobs.empty() && entry.knobs[0].integer) entry.sweep = entry.knobs[0].name;
  if (!j.contains("mu")) return entry;
  entry.knobs.push_back({"mu", j["mu"], 0, 1024, false, "Coulomb's coefficient of friction; 0: none"});
  entry.make = with_friction_of_knob(std::move(entry.make));
  return entry;
}

std::vector<SceneEntry>& catalog() {
  static std::vector<SceneEntry> all = [] {
    const std::map<std::string, Make> make = makers();
    return mapped(nlohmann::json::parse(catalog_json()),
                  [&](const nlohmann::json& j) { return entry_of(j, make.at(j.at("name"))); });
  }();
  return all;
}

}  // namespace

std::span<const SceneEntry> scenes() { return catalog(); }

void add_scene(SceneEntry entry) {
  if (find_scene(entry.name))
    throw std::invalid_argument("a scene of the name '" + entry.name + "' is registered already");
  catalog().push_back(std::move(entry));
}

const SceneEntry* find_scene(std::string_view name) {
  const auto found = std::ranges::find(scenes(), name, &SceneEntry::name);
  return found == scenes().end() ? nullptr : &*found;
}

}  // namespace zwang
