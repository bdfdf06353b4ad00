#include <CLI/CLI.hpp>
#include <cstdio>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/scenes/catalog.h>

namespace zwang {

int scenes_command(std::vector<std::string> words) {
  CLI::App options("The scenes: name, what it is, knobs with their defaults and ranges.");
  introduce(options, "scenes",
            "  ./zwang scenes\n"
            "  ./zwang bench --scenes \"tower(boxes=10,100),hand(contacts=64,seed=1..5)\"");
  if (!read(options, std::move(words))) return done;
  for (const SceneEntry& scene : scenes()) {
    std::printf("%-18s %s\n", scene.name.c_str(), scene.line.c_str());
    for (const Knob& k : scene.knobs)
      std::printf("%-18s   %s=%g   %g..%g   %s%s\n", "", k.name.c_str(), k.value, k.low, k.high, k.help.c_str(),
                  k.name == scene.sweep ? " (swept in charts)" : "");
  }
  return done;
}

}  // namespace zwang
