#include <zwang/bench/scenes/catalog.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/bench/scenes/families.h>
#include <zwang/bench/scenes/friction/families.h>
#include <zwang/bench/scenes/friction/friction.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/core/files/embedded.h>

ZWANG_EMBEDDED(catalog_json, ZWANG_CATALOG)

namespace zwang {
namespace {

using Make = std::function<Instance(const Knobs&)>;

std::map<std::string, Make> makers() {
  std::map<std::string, Make> all{{"tower", tower},
                                  {"stack", stack},
                                  {"wall", wall},
                                  {"pile", pile},
                                  {"arch", arch},
                                  {"chain", chain},
                                  {"four_bar", four_bar},
                                  {"leash", leash},
                                  {"hand", hands},
                                  {"hands", hands},
                                  {"incline", incline},
                                  {"crate", crate},
                                  {"pinch", pinch},
                                  {"ladder", ladder},
                                  {"ball", ball},
                                  {"belt", belt},
                                  {"peg", peg},
                                  {"dome", dome},
                                  {"cards", cards},
                                  {"heap", heap},
                                  {"MR", mass_ratio},
                                  {"MR1", mass_ratio_one_contact},
                                  {"MRC", mass_ratio_chain},
                                  {"NPE", near_parallel_equalities},
                                  {"LOOP", four_bar_loop},
                                  {"GAP", contact_gap},
                                  {"INC", inconsistent_equalities},
                                  {"WEAK", weak_contacts},
                                  {"NPI", near_parallel_contacts},
                                  {"WED", wedges},
                                  {"MANYF", many_on_a_face},
                                  {"MANYR", many_tilted},
                                  {"UNIT", length_unit},
                                  {"ROW", row_scale},
                                  {"HUGE", huge_offsets},
                                  {"ANI", thin_bodies},
                                  {"CHAIN", long_chain},
                                  {"STK", stack_of_masses},
                                  {"PIVOT", exponential_pivots},
                                  {"CYCLE", pivot_cycle},
                                  {"FLIP", flipping_stack},
                                  {"HAND", crowded_hands},
                                  {"random", random_rows}};
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
    std::vector<SceneEntry> entries;
    const std::map<std::string, Make> make = makers();
    for (const nlohmann::json& j : nlohmann::json::parse(catalog_json()))
      entries.push_back(entry_of(j, make.at(j.at("name"))));
    return entries;
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
