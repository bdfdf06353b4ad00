#include "bench/scenes/catalog.h"

#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "bench/scenes/families.h"
#include "bench/scenes/physical.h"
#include "core/nearest.h"

namespace zwang {
namespace {

// Splits at commas outside parentheses.
std::vector<std::string> split(std::string_view text) {
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

double parse_number(const std::string& scene, const std::string& knob, const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc{} && end == text.data() + text.size()) return value;
  throw std::invalid_argument("scene '" + scene + "': " + knob + "=" + text + " should be a number");
}

std::string format(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
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
      throw std::invalid_argument(place + format(v) + " should be " + (k.integer ? "an integer" : "a number") +
                                  " from " + format(k.low) + " to " + format(k.high));
  if (!(high >= low && high - low <= 1e6))
    throw std::invalid_argument(place + text + " should rise, over a million values at most");
  for (int i = 0; low + i <= high; ++i) out.values.push_back(low + i);
}

std::vector<KnobValues> parse_knobs(const SceneEntry& scene, const std::string& text) {
  std::vector<KnobValues> all;
  std::stringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const auto equal = part.find('=');
    if (equal != std::string::npos) {
      const std::string name = part.substr(0, equal);
      std::vector<std::string> names;
      const Knob* found = nullptr;
      for (const Knob& k : scene.knobs) {
        names.push_back(k.name);
        if (k.name == name) found = &k;
      }
      if (!found)
        throw std::invalid_argument("scene '" + scene.name + "' has no knob '" + name + "'" +
                                    did_you_mean(name, names));
      all.push_back({found, {}});
      part = part.substr(equal + 1);
    }
    if (all.empty()) throw std::invalid_argument("scene '" + scene.name + "': '" + part + "' should be knob=value");
    append_values(scene, part, all.back());
  }
  return all;
}

}  // namespace

namespace {

const Knob seed_knob{"seed", 1, 0, 1e9, true, "of the random draws"};
const Knob push_knob{"push", 0.25, 0, 4, false, "largest random push on a box, in weights; 0 leaves it at rest"};
const Knob limits_knob{"limits", 5, 0, 20, true, "violated joint limits"};
const Knob draws_knob{"seed", 1, 0, 1e9, true, "of the rows"};
const Knob drift_knob{"drift", 0x1p-13, 0, 0x1p-7, false, "opening of the joints (m)"};

}  // namespace

std::span<const SceneEntry> scenes() {
  static const std::vector<SceneEntry> all = {
      // One line a scene.
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
      {"MR",
       "MR",
       "ten boxes on four corners each, the top one heavier: mass ratio 2^k",
       "k",
       {{"k", 4, 0, 48, true, "log2 of the mass ratio"}},
       mass_ratio},
      {"MR1",
       "MR1",
       "ten masses on a line with one contact each, the top one heavier: mass ratio 2^k",
       "k",
       {{"k", 4, 0, 48, true, "log2 of the mass ratio"}},
       mass_ratio_one_contact},
      {"MRC",
       "MRC",
       "six bodies on ball joints, masses 1 and 2^k in turn, one contact each; known answer",
       "k",
       {{"k", 4, 0, 48, true, "log2 of the mass ratio"}, {"seed", 1, 0, 1e9, true, "of the geometry and the answer"}},
       mass_ratio_chain},
      {"NPE",
       "NPE",
       "three pairs of equality rows a and a + 2^-k d, six contacts: near-parallel equalities",
       "k",
       {{"k", 3, 1, 45, true, "-log2 of the angle between the rows of a pair"},
        {"seed", 1, 0, 1e9, true, "of the rows"}},
       near_parallel_equalities},
      {"LOOP",
       "LOOP",
       "four-bar linkage, 20 rows of rank 17, one hinge tilted by 2^-k",
       "k",
       {{"k", 3, 0, zero_knob, true, "-log2 of the tilt; 60: no tilt"}},
       four_bar_loop},
      {"GAP",
       "GAP",
       "three contact rows whose sum is 0, infeasible (or feasible) by 2^-k",
       "k",
       {{"k", 3, 1, zero_knob, true, "-log2 of the gap; 60: none, feasible"},
        {"feasible", 0, 0, 1, true, "1: the gap leaves room"}},
       contact_gap},
      {"INC",
       "INC",
       "equality rows a and 2a that contradict each other by 2^-k",
       "k",
       {{"k", 3, 0, zero_knob, true, "-log2 of the contradiction; 60: none, feasible"}},
       inconsistent_equalities},
      {"WEAK",
       "WEAK",
       "twelve touching contacts, six of them push with 2^-k only",
       "k",
       {{"k", 0, 0, zero_knob, true, "-log2 of the weak multipliers; 60: none"},
        {"seed", 1, 0, 1e9, true, "of the rows"}},
       weak_contacts},
      {"NPI",
       "NPI",
       "four pairs of pushing contacts with normals a and a + 2^-k d",
       "k",
       {{"k", 3, 1, 45, true, "-log2 of the angle between the rows of a pair"}, draws_knob},
       near_parallel_contacts},
      {"WED",
       "WED",
       "three wedges that open by 2^-k and push a mass out with 2^k",
       "k",
       {{"k", 3, 1, 48, true, "-log2 of the opening"}},
       wedges},
      {"MANYF",
       "MANYF",
       "one body on many contacts of one face: rank 3",
       "contacts",
       {{"contacts", 6, 4, 1000, true, "number of contacts"}, draws_knob},
       many_on_a_face},
      {"MANYR",
       "MANYR",
       "one body among many contacts of tilted normals: rank 6",
       "contacts",
       {{"contacts", 6, 1, 1000, true, "number of contacts"}, draws_knob},
       many_tilted},
      {"UNIT",
       "UNIT",
       "chain of four bodies, eight contacts, lengths in units of 2^-k m",
       "k",
       {{"k", 0, -20, 20, true, "log2 of the length unit's inverse"}, draws_knob},
       length_unit},
      {"ROW",
       "ROW",
       "the same chain, three of its rows times 2^k",
       "k",
       {{"k", 0, -500, 500, true, "log2 of the factor"},
        {"zero", 0, 0, 3, true, "1..3: one more row without entries, c = 0, 2^-40 (infeasible), -2^-40"},
        draws_knob},
       row_scale},
      {"HUGE",
       "HUGE",
       "the same chain, c times 2^k",
       "k",
       {{"k", 0, 0, 1000, true, "log2 of the factor"}, draws_knob},
       huge_offsets},
      {"ANI",
       "ANI",
       "the same chain, one inertia of each body divided by 2^k",
       "k",
       {{"k", 0, 0, 44, true, "log2 of the ratio"}, draws_knob},
       thin_bodies},
      {"CHAIN",
       "CHAIN",
       "rods on ball joints end to end, dyadic, with a known answer",
       "links",
       {{"links", 8, 1, 4096, true, "number of links"}, {"seed", 1, 0, 1e9, true, "of the answer"}},
       long_chain},
      {"STK",
       "STK",
       "equal masses one on another, one contact each; at rest",
       "boxes",
       {{"boxes", 16, 1, 4096, true, "number of masses"}},
       stack_of_masses},
      {"PIVOT",
       "PIVOT",
       "Murty's rows, on which exchanging one row at a time takes 2^n - 1 steps",
       "n",
       {{"n", 4, 1, 16, true, "unknowns, and rows"}, {"reversed", 0, 0, 1, true, "1: rows in reversed order"}},
       exponential_pivots},
      {"CYCLE",
       "PIVOT",
       "small integers on which block principal pivoting cycles",
       "n",
       {{"n", 5, 5, 8, true, "unknowns, and rows"}},
       pivot_cycle},
      {"FLIP",
       "FLIP",
       "a frame of a stack of ten boxes whose contacts come and go within 2^-k",
       "k",
       {{"k", 3, 3, 48, true, "-log2 of the heights (m)"},
        {"frame", 0, 0, 4095, true, "number of the frame"},
        {"seed", 1, 0, 1e9, true, "of the film"}},
       flipping_stack},
      {"HAND",
       "HAND",
       "hands with all limits violated and 30 contacts: more rows than unknowns",
       "hands",
       {{"hands", 1, 1, 64, true, "number of hands"}, seed_knob},
       crowded_hands},
      {"random",
       "random",
       "sparse random rows with a known answer",
       "n",
       {{"n", 60, 1, 100000, true, "unknowns"},
        {"m", 80, 0, 200000, true, "rows"},
        {"entries", 6, 1, 100, true, "entries of a row"},
        {"equalities", .25, 0, 1, false, "fraction of equality rows"},
        {"active", .5, 0, 1, false, "fraction of inequality rows that push"},
        {"condition", 4, 0, 80, true, "log2 of the ratio of largest to smallest mass"},
        {"redundancy", .1, 0, 1, false, "fraction of rows that are sums of two others"},
        {"seed", 1, 0, 1e9, true, "of everything"}},
       random_rows},
  };
  return all;
}

const SceneEntry* find_scene(std::string_view name) {
  for (const SceneEntry& e : scenes())
    if (e.name == name) return &e;
  return nullptr;
}

std::vector<Instance> make_scenes(std::string_view text, std::uint64_t seed) {
  std::vector<Instance> all;
  for (const std::string& part : split(text)) {
    const auto open = part.find('(');
    const std::string name = part.substr(0, open);
    const SceneEntry* scene = find_scene(name);
    if (!scene) {
      std::vector<std::string> names;
      for (const SceneEntry& e : scenes()) names.push_back(e.name);
      throw std::invalid_argument("no scene '" + name + "'" + did_you_mean(name, names) +
                                  " (./zwang scenes lists all)");
    }
    if (open != std::string::npos && part.back() != ')')
      throw std::invalid_argument("scene '" + part + "': a closing parenthesis should follow the knobs");
    const auto chosen = open == std::string::npos ? std::vector<KnobValues>()
                                                  : parse_knobs(*scene, part.substr(open + 1, part.size() - open - 2));
    // An odometer over all combinations.
    std::vector<std::size_t> digit(chosen.size(), 0);
    for (bool more = true; more;) {
      Knobs knobs;
      for (const Knob& k : scene->knobs) knobs[k.name] = k.name == "seed" ? static_cast<double>(seed) : k.value;
      std::string label;
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        knobs[chosen[i].knob->name] = chosen[i].values[digit[i]];
        label += (i ? "," : "") + chosen[i].knob->name + "=" + format(chosen[i].values[digit[i]]);
      }
      Instance instance = scene->make(knobs);
      instance.problem.name = label.empty() ? name : name + "(" + label + ")";
      instance.family = scene->family;
      instance.knob = scene->sweep;
      if (!scene->sweep.empty()) instance.knob_value = knobs.at(scene->sweep);
      if (knobs.contains("seed")) instance.seed = static_cast<std::uint64_t>(knobs.at("seed"));
      all.push_back(std::move(instance));
      more = false;
      for (std::size_t i = digit.size(); i-- > 0 && !more;) {
        more = ++digit[i] < chosen[i].values.size();
        if (!more) digit[i] = 0;
      }
    }
  }
  return all;
}

}  // namespace zwang
