#include <zwang/bench/scenes/catalog.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include <zwang/bench/scenes/families.h>
#include <zwang/bench/scenes/friction/families.h>
#include <zwang/bench/scenes/friction/friction.h>
#include <zwang/bench/scenes/physical.h>

namespace zwang {
namespace {

Knob integer(const char* name, double value, double low, double high, const char* help) {
  return {name, value, low, high, true, help};
}
Knob real(const char* name, double value, double low, double high, const char* help) {
  return {name, value, low, high, false, help};
}
Knob seed(const char* help) { return integer("seed", 1, 0, 1e9, help); }

const Knob push_knob = real("push", 0.25, 0, 4, "largest random push on a box, in weights; 0 leaves it at rest");
Knob mu_knob(double value) { return real("mu", value, 0, 1024, "Coulomb's coefficient of friction; 0: none"); }
const Knob limits_knob = integer("limits", 5, 0, 20, "violated joint limits");
const Knob drift_knob = real("drift", 0x1p-13, 0, 0x1p-7, "opening of the joints (m)");

// Its family is its name, and charts sweep its first knob, where that counts something.
template <class... Knobs>
SceneEntry without_contacts(const char* name, Instance (*make)(const zwang::Knobs&), const char* line,
                            const Knobs&... knobs) {
  SceneEntry entry{.name = name, .family = name, .line = line, .knobs = {knobs...}, .make = make};
  if (entry.knobs[0].integer) entry.sweep = entry.knobs[0].name;
  return entry;
}

// A scene that leaves its contacts as they are gets friction as a matrix does (friction/friction.h).
template <class... Knobs>
SceneEntry scene(const char* name, Instance (*make)(const zwang::Knobs&), const char* line, const Knobs&... knobs) {
  SceneEntry entry = without_contacts(name, make, line, knobs...);
  entry.knobs.push_back(mu_knob(0));
  entry.make = [make](const zwang::Knobs& all) {
    Instance made = make(all);
    const double mu = friction_of(all);
    return mu > 0 && !made.problem.has_tangents() ? with_friction(made, mu) : made;
  };
  return entry;
}

// A scene in which friction decides, and so is there unless it is asked away.
template <class... Knobs>
SceneEntry rough(const char* name, Instance (*make)(const zwang::Knobs&), const char* line, double mu,
                 const Knobs&... knobs) {
  SceneEntry entry = without_contacts(name, make, line, knobs...);
  entry.knobs.push_back(mu_knob(mu));
  return entry;
}

SceneEntry of_family(const char* family, SceneEntry entry) {
  entry.family = family;
  return entry;
}

std::vector<SceneEntry> frictionless_and_rough() {
  return {
      scene("tower", tower, "boxes one on another, narrower upwards, four corner contacts a face; at rest",
            integer("boxes", 10, 1, 1000, "number of boxes")),
      scene("stack", stack, "equal boxes one on another, four corner contacts a face, pushed about",
            integer("boxes", 10, 1, 1000, "number of boxes"), push_knob, seed("of the random draws")),
      scene("wall", wall, "bricks in running bond, four corner contacts where two overlap, pushed about",
            integer("boxes", 25, 1, 20000, "number of bricks, rounded up to whole courses"), push_knob,
            seed("of the random draws")),
      scene("pile", pile, "spheres heaped into a square pyramid on the ground, rolling apart",
            integer("spheres", 30, 1, 20000, "number of spheres"),
            real("gap", 0x1p-8, 0, 0.125, "largest gap or penetration, as a part of the diameter"),
            real("mass_ratio", 1, 1, 0x1p20, "of the heaviest sphere to the lightest"),
            seed("of the random draws")),
      scene("arch", arch, "wedge-shaped stones in half a circle, four contacts a joint",
            integer("stones", 9, 3, 500, "number of stones")),
      without_contacts("chain", chain, "links on ball joints, hanging from one end, tumbling",
                       integer("links", 16, 1, 4000, "number of links"),
                       real("drift", 0, 0, 0.125, "opening of the joints (m)"), seed("of the random draws")),
      without_contacts("four_bar", four_bar, "a linkage of three bars and four hinges: 20 rows of rank 17",
                       real("lean", 0.5, -2, 2, "horizontal offset of the coupler (m)")),
      without_contacts("leash", leash, "the constraint of docs/add-a-constraint.md: dogs pulling at their leashes",
                       integer("dogs", 4, 1, 1000, "number of dogs"), seed("of the random draws")),
      scene(
          "hand", hands, "the 16-body hand pressed into a wall: joints, violated limits, redundant contacts",
          integer("contacts", 16, 0, 400, "number of contacts"), limits_knob, drift_knob,
          integer("feasible", 1, 0, 1, "1: feasible by construction; 0: gaps at random, perhaps infeasible"),
          integer("locked", 0, 0, 1, "1: index PIP welded; with limits=20 and drift=0 its limit contradicts the weld"),
          seed("of the random draws")),
      scene("hands", hands, "independent hands in one problem", integer("hands", 2, 1, 64, "number of hands"),
            integer("contacts", 16, 0, 400, "contacts of each hand"), limits_knob, drift_knob,
            seed("of the random draws")),
      rough("incline", incline, "a box on a slope: rests where mu >= slope", 0.75,
            real("slope", 0.75, 0, 16, "tangent of the slope"), real("speed", 0, -16, 16, "downhill (m/s)")),
      rough("crate", crate, "a crate pushed at its middle: slides where push > mu, tips where push > 1/tall", 0.5,
            real("tall", 1, 0x1p-6, 64, "height over width"), real("push", 0.25, 0, 16, "in weights")),
      rough("pinch", pinch, "a block between two fingers: held where 2 mu squeeze >= 1", 0.5,
            real("squeeze", 2, 0, 1024, "force of each finger, in weights")),
      rough("ladder", ladder, "a ladder against a wall: rests where slope >= (1 - mu^2) / (2 mu)", 0.5,
            real("slope", 1, 0x1p-6, 64, "tangent of its angle with the ground")),
      rough("ball", ball, "a ball thrown along the ground: slides, then rolls", 0.5, real("speed", 7, -64, 64, "m/s"),
            real("spin", 0, -256, 256, "rad/s; 2 speed rolls")),
      rough("belt", belt, "a box on a running belt", 0.5, real("speed", 1, -16, 16, "of the belt (m/s)"),
            real("carried", 0, -16, 16, "speed of the box (m/s)")),
      rough("peg", peg, "a peg in a slot, loaded beside its axis: jams where 2 mu load offset/apart >= 1 + load", 0.75,
            real("load", 8, 0, 1024, "in weights"), real("offset", 0.5, 0, 16, "of the load from the axis (m)"),
            real("apart", 0.5, 0x1p-6, 1, "height between the contacts (m)")),
      rough("dome", dome, "rings of stones up to an eye, four contacts a joint: friction holds it", 0.75,
            integer("rings", 3, 1, 100, "rings of stones"), integer("sectors", 8, 3, 400, "stones of a ring")),
      rough("cards", cards, "a house of cards: friction holds it", 0.5, integer("storeys", 3, 1, 60, "storeys"),
            real("lean", 0.25, 0x1p-6, 0.5, "tangent of the cards' lean")),
      rough("heap", heap, "balls poured on one spot, at rest: friction holds it", 1,
            integer("balls", 40, 1, 300, "number of balls"), seed("of their sizes")),
      scene("MR", mass_ratio, "ten boxes on four corners each, the top one heavier: mass ratio 2^k",
            integer("k", 4, 0, 48, "log2 of the mass ratio")),
      scene("MR1", mass_ratio_one_contact,
            "ten masses on a line with one contact each, the top one heavier: mass ratio 2^k",
            integer("k", 4, 0, 48, "log2 of the mass ratio")),
      scene("MRC", mass_ratio_chain,
            "six bodies on ball joints, masses 1 and 2^k in turn, one contact each; known answer",
            integer("k", 4, 0, 48, "log2 of the mass ratio"), seed("of the geometry and the answer")),
      scene("NPE", near_parallel_equalities,
            "three pairs of equality rows a and a + 2^-k d, six contacts: near-parallel equalities",
            integer("k", 3, 1, 45, "-log2 of the angle between the rows of a pair"), seed("of the rows")),
      without_contacts("LOOP", four_bar_loop, "four-bar linkage, 20 rows of rank 17, one hinge tilted by 2^-k",
                       integer("k", 3, 0, zero_knob, "-log2 of the tilt; 60: no tilt")),
      scene("GAP", contact_gap, "three contact rows whose sum is 0, infeasible (or feasible) by 2^-k",
            integer("k", 3, 1, zero_knob, "-log2 of the gap; 60: none, feasible"),
            integer("feasible", 0, 0, 1, "1: the gap leaves room")),
      scene("INC", inconsistent_equalities, "equality rows a and 2a that contradict each other by 2^-k",
            integer("k", 3, 0, zero_knob, "-log2 of the contradiction; 60: none, feasible")),
      scene("WEAK", weak_contacts, "twelve touching contacts, six of them push with 2^-k only",
            integer("k", 0, 0, zero_knob, "-log2 of the weak multipliers; 60: none"), seed("of the rows")),
      scene("NPI", near_parallel_contacts, "four pairs of pushing contacts with normals a and a + 2^-k d",
            integer("k", 3, 1, 45, "-log2 of the angle between the rows of a pair"), seed("of the rows")),
      scene("WED", wedges, "three wedges that open by 2^-k and push a mass out with 2^k",
            integer("k", 3, 1, 48, "-log2 of the opening")),
      scene("MANYF", many_on_a_face, "one body on many contacts of one face: rank 3",
            integer("contacts", 6, 4, 1000, "number of contacts"), seed("of the rows")),
      scene("MANYR", many_tilted, "one body among many contacts of tilted normals: rank 6",
            integer("contacts", 6, 1, 1000, "number of contacts"), seed("of the rows")),
      scene("UNIT", length_unit, "chain of four bodies, eight contacts, lengths in units of 2^-k m",
            integer("k", 0, -20, 20, "log2 of the length unit's inverse"), seed("of the rows")),
      scene("ROW", row_scale, "the same chain, three of its rows times 2^k",
            integer("k", 0, -500, 500, "log2 of the factor"),
            integer("zero", 0, 0, 3, "1..3: one more row without entries, c = 0, 2^-40 (infeasible), -2^-40"),
            seed("of the rows")),
      scene("HUGE", huge_offsets, "the same chain, c times 2^k", integer("k", 0, 0, 1000, "log2 of the factor"),
            seed("of the rows")),
      scene("ANI", thin_bodies, "the same chain, one inertia of each body divided by 2^k",
            integer("k", 0, 0, 44, "log2 of the ratio"), seed("of the rows")),
      without_contacts("CHAIN", long_chain, "rods on ball joints end to end, dyadic, with a known answer",
                       integer("links", 8, 1, 4096, "number of links"), seed("of the answer")),
      scene("STK", stack_of_masses, "equal masses one on another, one contact each; at rest",
            integer("boxes", 16, 1, 4096, "number of masses")),
      scene("PIVOT", exponential_pivots, "Murty's rows, on which exchanging one row at a time takes 2^n - 1 steps",
            integer("n", 4, 1, 16, "unknowns, and rows"), integer("reversed", 0, 0, 1, "1: rows in reversed order")),
      of_family("PIVOT", scene("CYCLE", pivot_cycle, "small integers on which block principal pivoting cycles",
                               integer("n", 5, 5, 8, "unknowns, and rows"))),
      scene("FLIP", flipping_stack, "a frame of a stack of ten boxes whose contacts come and go within 2^-k",
            integer("k", 3, 3, 48, "-log2 of the heights (m)"), integer("frame", 0, 0, 4095, "number of the frame"),
            seed("of the film")),
      scene("HAND", crowded_hands, "hands with all limits violated and 30 contacts: more rows than unknowns",
            integer("hands", 1, 1, 64, "number of hands"), seed("of the random draws")),
      scene("random", random_rows, "sparse random rows with a known answer", integer("n", 60, 1, 100000, "unknowns"),
            integer("m", 80, 0, 200000, "rows"), integer("entries", 6, 1, 100, "entries of a row"),
            real("equalities", .25, 0, 1, "fraction of equality rows"),
            real("active", .5, 0, 1, "fraction of inequality rows that push"),
            integer("condition", 4, 0, 80, "log2 of the ratio of largest to smallest mass"),
            real("redundancy", .1, 0, 1, "fraction of rows that are sums of two others"), seed("of everything"))};
}

std::vector<SceneEntry>& catalog() {
  static std::vector<SceneEntry> all = [] {
    std::vector<SceneEntry> entries = frictionless_and_rough();
    std::ranges::move(friction_families(), std::back_inserter(entries));
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
