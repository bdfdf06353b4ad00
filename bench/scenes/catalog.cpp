#include <zwang/bench/scenes/catalog.h>

#include <zwang/bench/scenes/families.h>
#include <zwang/bench/scenes/physical.h>

namespace zwang {
namespace {

const Knob push_knob{"push", 0.25, 0, 4, false, "largest random push on a box, in weights; 0 leaves it at rest"};
const Knob limits_knob{"limits", 5, 0, 20, true, "violated joint limits"};
const Knob drift_knob{"drift", 0x1p-13, 0, 0x1p-7, false, "opening of the joints (m)"};

std::vector<SceneEntry> mechanical_scenes() {
  return {
      {"tower",
       "tower",
       "boxes one on another, narrower upwards, four corner contacts a face; at rest",
       "boxes",
       {{"boxes", 10, 1, 1000, true, "number of boxes"}},
       tower},
      {"stack",
       "stack",
       "equal boxes one on another, four corner contacts a face, pushed about",
       "boxes",
       {{"boxes", 10, 1, 1000, true, "number of boxes"}, push_knob, seed_knob},
       stack},
      {"wall",
       "wall",
       "bricks in running bond, four corner contacts where two overlap, pushed about",
       "boxes",
       {{"boxes", 25, 1, 2000, true, "number of bricks, rounded up to whole courses"}, push_knob, seed_knob},
       wall},
      {"pile",
       "pile",
       "spheres heaped into a square pyramid on the ground, rolling apart",
       "spheres",
       {{"spheres", 30, 1, 2000, true, "number of spheres"},
        {"gap", 0x1p-8, 0, 0.125, false, "largest gap or penetration, as a part of the diameter"},
        seed_knob},
       pile},
      {"arch",
       "arch",
       "wedge-shaped stones in half a circle, four contacts a joint, no friction",
       "stones",
       {{"stones", 9, 3, 500, true, "number of stones"}},
       arch},
      {"chain",
       "chain",
       "links on ball joints, hanging from one end, tumbling",
       "links",
       {{"links", 16, 1, 4000, true, "number of links"},
        {"drift", 0, 0, 0.125, false, "opening of the joints (m)"},
        seed_knob},
       chain},
      {"four_bar",
       "four_bar",
       "a linkage of three bars and four hinges: 20 rows of rank 17",
       "",
       {{"lean", 0.5, -2, 2, false, "horizontal offset of the coupler (m)"}},
       four_bar},
      {"leash",
       "leash",
       "the constraint of docs/add-a-constraint.md: dogs pulling at their leashes",
       "dogs",
       {{"dogs", 4, 1, 1000, true, "number of dogs"}, seed_knob},
       leash},
      {"hand",
       "hand",
       "the 16-body hand pressed into a wall: joints, violated limits, redundant contacts",
       "contacts",
       {{"contacts", 16, 0, 400, true, "number of contacts"},
        limits_knob,
        drift_knob,
        {"feasible", 1, 0, 1, true, "1: feasible by construction; 0: gaps at random, perhaps infeasible"},
        {"locked", 0, 0, 1, true, "1: index PIP welded; with limits=20 and drift=0 its limit contradicts the weld"},
        seed_knob},
       hands},
      {"hands",
       "hands",
       "independent hands in one problem",
       "hands",
       {{"hands", 2, 1, 64, true, "number of hands"},
        {"contacts", 16, 0, 400, true, "contacts of each hand"},
        limits_knob,
        drift_knob,
        seed_knob},
       hands},
  };
}

}  // namespace

std::span<const SceneEntry> scenes() {
  static const std::vector<SceneEntry> all = [] {
    std::vector<SceneEntry> entries = mechanical_scenes();
    for (SceneEntry& family : families()) entries.push_back(std::move(family));
    return entries;
  }();
  return all;
}

const SceneEntry* find_scene(std::string_view name) {
  for (const SceneEntry& e : scenes())
    if (e.name == name) return &e;
  return nullptr;
}

}  // namespace zwang
