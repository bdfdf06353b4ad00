#include <CLI/CLI.hpp>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/scenes/catalog.h>
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

}  // namespace

int export_command(std::vector<std::string> words) {
  CLI::App options("Writes a scene's problem to a file (docs/formats.md), with its reference where known.");
  introduce(options, "export",
            "  ./zwang export hand --contacts=64 --out hand.h5\n"
            "  ./zwang export \"hand(contacts=64,seed=3)\" --out hand.h5");
  std::string scene, out;
  options.add_option("SCENE", scene, "REQUIRED: ./zwang scenes lists them with their knobs");
  options.add_option("--out", out, "REQUIRED: the file to write")->type_name("FILE");
  std::optional<Law> law;
  add_law(options, law);
  options.allow_extras();
  if (!read(options, std::move(words))) return done;
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
