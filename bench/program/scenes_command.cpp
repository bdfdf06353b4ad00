#include <CLI/CLI.hpp>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

struct Group {
  const char* title;
  bool (*holds)(const SceneEntry& scene);
};

bool of_the_atlas(const SceneEntry& scene) { return std::isupper(static_cast<unsigned char>(scene.name[0])) != 0; }
bool rubs(const SceneEntry& scene) {
  return std::ranges::any_of(scene.knobs, [](const Knob& k) { return k.name == "mu" && k.value > 0; });
}

constexpr Group groups[] = {
    {"Everyday: stacks, mechanisms, hands", [](const SceneEntry& s) { return !of_the_atlas(s) && !rubs(s); }},
    {"Friction decides what happens", [](const SceneEntry& s) { return !of_the_atlas(s) && rubs(s); }},
    {"The stability atlas: from benign to impossible; with friction from MU0 on", of_the_atlas}};

// Whole numbers in full, small powers of two as such.
std::string short_text(double value) {
  int exponent;
  if (value > 0 && value < 0x1p-6 && std::frexp(value, &exponent) == 0.5) return printed("2^%d", exponent - 1);
  return value == std::round(value) && std::abs(value) < 1e15 ? printed("%.0f", value) : printed("%g", value);
}

void print_whole(const std::string& name) {
  const Problem problem = make_scenes(name).front().problem;  // throws where there is no such scene
  const SceneEntry* found = find_scene(name);
  if (!found) throw std::invalid_argument("'" + name + "' should be a scene's name alone (./zwang scenes lists all)");
  const SceneEntry& scene = *found;
  std::printf("%-18s %s\n", name.c_str(), scene.line.c_str());
  std::printf("%-18s %s, %s as it stands\n", "", counted(problem.size(), "unknown").c_str(),
              counted(problem.rows(), "row").c_str());
  for (const Knob& k : scene.knobs)
    std::printf("%-18s   %s=%s   %s..%s   %s%s\n", "", k.name.c_str(), short_text(k.value).c_str(),
                short_text(k.low).c_str(), short_text(k.high).c_str(), k.help.c_str(),
                k.name == scene.sweep ? " (swept in charts)" : "");
}

}  // namespace

int scenes_command(std::vector<std::string> words) {
  CLI::App options("The scenes by groups; with names: their sizes, and their knobs with defaults and ranges.");
  introduce(options, "scenes",
            "  ./zwang scenes\n"
            "  ./zwang scenes hand wall\n"
            "  ./zwang bench --scenes \"tower(boxes=10,100),hand(contacts=64,seed=1..5)\"");
  std::vector<std::string> names;
  options.add_option("NAME", names, "scenes to show whole")->type_name("");
  if (!read(options, std::move(words))) return done;
  for (const std::string& name : names) print_whole(name);
  if (!names.empty()) return done;
  for (const Group& group : groups) {
    std::printf("%s%s\n", &group == groups ? "" : "\n", group.title);
    for (const SceneEntry& scene : scenes())
      if (group.holds(scene)) std::printf("  %-12s %s\n", scene.name.c_str(), scene.line.c_str());
  }
  std::puts(
      "\n./zwang scenes NAME says its knobs. Every scene with contacts takes mu=, Coulomb's coefficient of friction.");
  return done;
}

}  // namespace zwang
