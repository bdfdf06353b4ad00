#include <unistd.h>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/suite/atlas_files.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/bench/suite/suite.h>
#include <zwang/core/files/problem_file.h>

namespace zwang {
namespace {

// "hand" with {"--contacts=64", "--seed", "2"} -> "hand(contacts=64,seed=2)".
std::string with_knobs(const std::string& scene, const std::vector<std::string>& words) {
  std::string knobs;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!words[i].starts_with("--")) throw std::invalid_argument("'" + words[i] + "' should be --KNOB=VALUE");
    std::string knob = words[i].substr(2);
    if (knob.find('=') == std::string::npos) {
      if (i + 1 == words.size()) throw std::invalid_argument(words[i] + " should be followed by a value");
      knob += "=" + words[++i];
    }
    knobs += (knobs.empty() ? "" : ",") + knob;
  }
  if (knobs.empty()) return scene;
  if (scene.find('(') != std::string::npos)
    throw std::invalid_argument("knobs stand either in '" + scene + "' or in options, not in both");
  return scene + "(" + knobs + ")";
}

int export_atlas(const std::string& directory, const std::string& families) {
  Progress bar(isatty(STDERR_FILENO));
  const auto progress = [&](std::size_t k, std::size_t of, const std::string& name) {
    bar.show(static_cast<double>(k) / static_cast<double>(of), name, -1);
  };
  const std::size_t count = write_atlas(directory, families, reference_cache(), progress);
  bar.clear();
  std::printf("%zu certified problems -> %s (listed in atlas.tsv)\n", count, directory.c_str());
  return done;
}

}  // namespace

int export_command(std::vector<std::string> words) {
  CLI::App options("Writes a scene's problem to a file (docs/formats.md), with its reference where known.");
  introduce(options, "export",
            "  ./zwang export hand --contacts=64 --out hand.h5\n"
            "  ./zwang export \"hand(contacts=64,seed=3)\" --out hand.h5\n"
            "  ./zwang export --atlas atlas --families NPE,LOOP");
  std::string scene, out, atlas, families;
  options.add_option("SCENE", scene, "REQUIRED but with --atlas: ./zwang scenes lists them with their knobs");
  options.add_option("--out", out, "REQUIRED with SCENE: the file to write")->type_name("FILE");
  options
      .add_option("--atlas", atlas, "instead: every point of the stability atlas with its certified truth, a file each")
      ->type_name("DIR");
  options.add_option("--families", families, "MR,NPE,...: of the atlas, only these");
  std::optional<Law> law;
  add_law(options, law);
  options.allow_extras();
  if (!read(options, std::move(words))) return done;
  if (!atlas.empty()) {
    if (!scene.empty() || !out.empty()) throw std::invalid_argument("--atlas takes neither a scene nor --out");
    if (law) throw std::invalid_argument("--atlas writes its problems as they are: no --law");
    return export_atlas(atlas, families);
  }
  if (scene.empty()) throw std::invalid_argument("SCENE is required (./zwang scenes lists them)");
  if (out.empty()) throw std::invalid_argument("--out FILE is required");

  const std::string text = with_knobs(scene, options.remaining());
  const std::vector<Instance> instances = make_scenes(text);
  if (instances.size() != 1)
    throw std::invalid_argument("'" + text + "' names " + std::to_string(instances.size()) +
                                " problems, a file holds one");
  const Instance instance = law ? under(*law, instances[0]) : instances[0];
  write_problem(out, instance);
  const Problem& p = instance.problem;
  std::printf("%s: %ld unknowns, %ld rows -> %s\n", p.name.c_str(), static_cast<long>(p.size()),
              static_cast<long>(p.rows()), out.c_str());
  return done;
}

}  // namespace zwang
