#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/scenes/scene_file.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

// Splits at commas outside parentheses.
std::vector<std::string> split_outside_parentheses(std::string_view text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char ch : text) {
    depth += ch == '(' ? 1 : ch == ')' ? -1 : 0;
    if (ch == ',' && depth == 0)
      parts.emplace_back();
    else
      parts.back() += ch;
  }
  return parts;
}

// A number, or 2^-13, as ./zwang scenes prints small powers of two.
double parse_number(const std::string& scene, const std::string& knob, const std::string& text) {
  const bool power = text.starts_with("2^");
  if (const auto value = number_in<double>(text.substr(power ? 2 : 0))) return power ? std::exp2(*value) : *value;
  throw std::invalid_argument("scene '" + scene + "': " + knob + "=" + text + " should be a number");
}

struct KnobValues {
  const Knob* knob;
  std::vector<double> values;
};

// "10", "1..5" or one more value of the knob named last ("boxes=10,100").
void append_values(const SceneEntry& scene, const std::string& text, KnobValues& out) {
  const auto dots = text.find("..");
  const double low = parse_number(scene.name, out.knob->name, text.substr(0, dots));
  const double high = dots == std::string::npos ? low : parse_number(scene.name, out.knob->name, text.substr(dots + 2));
  const Knob& k = *out.knob;
  const std::string place = "scene '" + scene.name + "': " + k.name + "=";
  for (const double v : {low, high})
    if (!(v >= k.low && v <= k.high) || (k.integer && v != std::floor(v)))
      throw std::invalid_argument(
          place + printed("%g should be %s from %g to %g", v, k.integer ? "an integer" : "a number", k.low, k.high));
  if (!(high >= low && high - low <= 1e6))
    throw std::invalid_argument(place + text + " should rise, over a million values at most");
  for (int i = 0; low + i <= high; ++i) out.values.push_back(low + i);
}

std::vector<KnobValues> parse_knobs(const SceneEntry& scene, const std::string& text) {
  std::vector<KnobValues> all;
  for (std::string part : split_outside_parentheses(text)) {
    const auto equal = part.find('=');
    if (equal != std::string::npos) {
      const std::string name = part.substr(0, equal);
      const auto found = std::ranges::find(scene.knobs, name, &Knob::name);
      if (found == scene.knobs.end())
        throw std::invalid_argument("scene '" + scene.name + "' has no knob '" + name + "'" +
                                    did_you_mean(name, names_of(scene.knobs, &Knob::name)));
      if (std::ranges::find(all, &*found, &KnobValues::knob) != all.end())
        throw std::invalid_argument("scene '" + scene.name + "': knob '" + name + "' is given twice");
      all.push_back({&*found, {}});
      part = part.substr(equal + 1);
    }
    if (all.empty()) throw std::invalid_argument("scene '" + scene.name + "': '" + part + "' should be knob=value");
    append_values(scene, part, all.back());
  }
  return all;
}

}  // namespace

std::vector<Instance> make_scenes(std::string_view text, std::uint64_t seed, std::optional<double> mu) {
  std::vector<Instance> all;
  for (const std::string& part : split_outside_parentheses(text)) {
    if (part.ends_with(".json")) {
      all.push_back(read_scene_file(part));
      continue;
    }
    const auto open = part.find('(');
    const std::string name = part.substr(0, open);
    const SceneEntry* scene = find_scene(name);
    if (!scene)
      throw std::invalid_argument("no scene '" + name + "'" +
                                  did_you_mean(name, names_of(scenes(), &SceneEntry::name)) +
                                  " (./zwang scenes lists all)");
    if (open != std::string::npos && part.back() != ')')
      throw std::invalid_argument("scene '" + part + "': a closing parenthesis should follow the knobs");
    auto chosen = open == std::string::npos ? std::vector<KnobValues>()
                                            : parse_knobs(*scene, part.substr(open + 1, part.size() - open - 2));
    const auto asked = std::ranges::find(scene->knobs, "mu", &Knob::name);
    if (mu && asked != scene->knobs.end() && std::ranges::find(chosen, &*asked, &KnobValues::knob) == chosen.end()) {
      chosen.push_back({&*asked, {}});
      append_values(*scene, printed("%.17g", *mu), chosen.back());
    }
    std::vector<std::pair<Knobs, std::string>> combinations(1);  // with their labels
    for (const Knob& k : scene->knobs)
      combinations[0].first[k.name] = k.name == "seed" ? static_cast<double>(seed) : k.value;
    for (const auto& [knob, values] : chosen) {
      std::vector<std::pair<Knobs, std::string>> longer;
      for (const auto& [knobs, label] : combinations)
        for (const double value : values) {
          longer.emplace_back(knobs, label + (label.empty() ? "" : ",") + knob->name + printed("=%g", value));
          longer.back().first[knob->name] = value;
        }
      combinations = std::move(longer);
    }
    for (const auto& [knobs, label] : combinations) {
      Instance& instance = all.emplace_back(scene->make(knobs));
      instance.problem.name = label.empty() ? name : name + "(" + label + ")";
      instance.family = scene->family;
      // Medians of problems with and without friction would say nothing of either.
      if (instance.problem.has_tangents() && asked != scene->knobs.end() && asked->value == 0)
        instance.family += " with friction";
      instance.knob = scene->sweep;
      if (!scene->sweep.empty()) instance.knob_value = knobs.at(scene->sweep);
      if (knobs.contains("seed")) instance.seed = static_cast<std::uint64_t>(knobs.at("seed"));
    }
  }
  return all;
}

}  // namespace zwang
