#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <zwang/bench/scenes/physical.h>
#include <zwang/core/problem/wording.h>
#include <zwang/experiments/god_hand/motion/grips.h>
#include <zwang/experiments/god_hand/motion/keyframes.h>
#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/scenes/site.h>

namespace zwang::god {
namespace {

using hand::Angles;
using Palm = Pose<double>;

constexpr Posture a_fist{80, 100, 70, {40, 0, 40, 50}};  // the thumb over the fingers
constexpr Posture grip{75, 55, 35, {60, -20, 30, 40}};   // down the sides of an object that the palm lies on
constexpr Posture hook{30, 105, 80, {0, -55, 0, 0}};     // about a bar under the first phalanxes, the thumb along them

Angles pointing(double share) {
  Angles out = a_fist.at(share);
  std::fill(out.begin() + 4, out.begin() + 8, 0.0);
  return out;
}

Keyframes at_flat_start(const Site& s) {
  const double high = s.clear_height(0.15, [&](double h) { return s.flat(h); });
  return {hand::standard(), s.flat(high), {}};
}

std::vector<Track> press(const Site& s) {
  Keyframes keys = at_flat_start(s);
  keys.stay(0.1).to(0.8, s.flat(0.005)).to(1.2, s.flat(-0.03)).stay(2.2).to(2.6, s.flat(0.03)).to(3, keys.start());
  return {keys.track()};
}

std::vector<Track> slide(const Site& s) {
  Keyframes keys = at_flat_start(s);
  keys.stay(0.1).to(0.7, s.flat(-0.015)).to(1.3, s.flat(-0.015, 0, 0.1)).to(2, s.flat(-0.015, 0, -0.04));
  keys.to(2.3, s.flat(-0.015)).to(3, keys.start());
  return {keys.track()};
}

// A bar with room under it is taken into the crook of the fingers, which alone lifts without friction. Anything else is
// gripped from above: the middle between finger tips and thumb comes over its middle, the palm onto it.
std::vector<Track> grasp(const Site& s) {
  const hand::Model& model = hand::standard();
  const Mat3 R = Site::axes(s.along, s.out);
  const double thick = s.solid_way(s.focus, -s.out);
  const bool bar = thick < 0.04 && s.depth.distance(s.focus - (thick + 0.02) * s.out, 0.02) > 0.015;
  const Posture& fingers = bar ? hook : grip;
  Palm low{Vec3::Zero(), R};
  if (bar) {
    const hand::Poses hooked = hand::forward_kinematics(low, fingers.at(1), model);
    const hand::Phalanx first = model.phalanx(7);
    low.position =
        s.focus - thick / 2 * s.out - hooked[7] * Vec3(0, 0.2 * first.length, -(first.radius + thick / 2 + 0.001));
  } else {
    const hand::Poses closing = hand::forward_kinematics(low, fingers.at(0.7), model);
    Vec3 grip = closing[3].position / 2;
    for (std::size_t f = 1; f < 5; ++f) grip += closing[3 + 3 * f].position / 8;
    const Vec3 within = s.focus - std::min(thick / 2, 0.03) * s.out;
    Vec3 middle = within;
    for (const Vec3& axis : {s.along, s.aside})
      middle += (s.solid_way(within, axis) - s.solid_way(within, -axis)) / 2 * axis;
    low = s.flat(0.006);
    for (const Vec3& axis : {s.along, s.aside}) low.position += axis.dot(middle - grip - low.position) * axis;
  }
  const auto over = [&](double height) { return Palm{low.position + height * s.out, R}; };
  const Angles open = fingers.at(0.1), closed = fingers.at(1);
  const double high = s.clear_height(0.15, over, open);
  Keyframes keys(model, over(high), open);
  keys.stay(0.1).to(0.9, low).to(1.5, low, closed).stay(1.8).to(2.3, over(0.1)).stay(2.7);
  keys.to(3.2, low).to(3.5, low, open).to(4, over(high));
  return {keys.track()};
}

std::vector<Track> poke(const Site& s) {
  const hand::Model& model = hand::standard();
  const Mat3 R = Site::axes(-s.out, s.along);
  const hand::Poses straight = hand::forward_kinematics({Vec3::Zero(), R}, {}, model);
  const hand::Phalanx last = model.phalanx(6);
  const Vec3 tip = straight[6] * Vec3(0, last.length / 2 + last.radius, 0);
  const auto tip_at = [&](double height) { return Palm{s.focus + height * s.out - tip, R}; };
  const double high = s.clear_height(0.1, tip_at);
  Keyframes keys(model, tip_at(high), {});
  keys.stay(0.1).to(0.5, tip_at(high), pointing(0.9)).to(0.9, tip_at(0.005)).to(1.3, tip_at(-0.04)).stay(2);
  keys.to(2.4, tip_at(0.05)).to(3, tip_at(high), {});
  return {keys.track()};
}

std::vector<Track> fist(const Site& s) {
  Keyframes keys = at_flat_start(s);
  keys.stay(0.1).to(0.7, s.flat(0.02)).to(1, s.flat(-0.025)).to(1.5, s.flat(-0.025), a_fist.at(0.95)).stay(1.8);
  keys.to(2.1, s.flat(-0.04)).to(2.4, s.flat(-0.02), a_fist.at(0.1)).to(3, keys.start(), {});
  return {keys.track()};
}

std::vector<Track> swipe(const Site& s) {
  constexpr double speed = 5;  // m/s
  const auto on_line = [&](double height) { return s.flat(height, 0.4 * height); };
  const double high = s.clear_height(0.25, on_line), length = std::hypot(2 * high, 0.8 * high);
  const double there = 0.3 + length / speed, back = there + 0.8;
  Keyframes keys(hand::standard(), on_line(high), {});
  keys.stay(0.3)
      .to(there, on_line(-high), Keyframes::Way::even)
      .stay(back)
      .to(back + length / speed, on_line(high), Keyframes::Way::even);
  keys.stay(2);
  return {keys.track()};
}

std::vector<Track> teleport(const Site& s) {
  const auto aside = [&](double h) { return s.flat(h, 0, 0.3); };
  const double high = std::max(s.clear_height(0.12, aside), s.clear_height(0.12, [&](double h) { return s.flat(h); }));
  Keyframes keys(hand::standard(), aside(high), {});
  keys.stay(0.5).to(0.501, s.flat(high), Keyframes::Way::jump).stay(1).to(1.3, s.flat(0.1)).stay(1.5);
  keys.to(1.501, s.flat(-0.2), Keyframes::Way::jump).stay(2.2).to(2.201, s.flat(0.1), Keyframes::Way::jump).stay(3);
  return {keys.track()};
}

// A slide that goes on while tracking is lost.
std::vector<Track> lost(const Site& s) {
  Keyframes keys = at_flat_start(s);
  keys.stay(0.1).to(0.7, s.flat(-0.015)).to(2.1, s.flat(-0.015, 0.08), Keyframes::Way::even).to(3, keys.start());
  keys.spoil(1.2, 1.5, [](Target& t) { t.tracked = false; });
  return {keys.track()};
}

std::vector<Track> not_numbers(const Site& s) {
  Keyframes keys = at_flat_start(s);
  keys.stay(0.1).to(0.8, s.flat(0.005)).to(1.2, s.flat(-0.03)).to(2.2, s.flat(-0.02, 0.03)).to(3, keys.start());
  const auto spoilt = [](Target& t) { t.palm.position.x() = std::numeric_limits<double>::quiet_NaN(); };
  keys.spoil(1.0, 1.005, spoilt).spoil(1.6, 1.62, [](Target& t) {
    t.angles.fill(std::numeric_limits<double>::quiet_NaN());
  });
  return {keys.track()};
}

// A loose object is held between two palms; on anything else both press side by side.
std::vector<Track> two_hands(const Site& s) {
  const std::array<double, 2> wide = s.extent(s.aside);
  const bool between = s.about.objects[s.object].loose() && wide[1] - wide[0] < 0.4;
  std::vector<Track> tracks;
  for (const bool left : {false, true}) {
    const hand::Model model = left ? hand::mirrored(hand::standard()) : hand::standard();
    const double side = left ? -1 : 1, half = model.palm_widths.z() / 2;
    if (!between) {
      const auto place = [&](double h) { return s.flat(h, 0, 0.15 * side); };
      const double high = s.clear_height(0.15, place, {}, model);
      Keyframes keys(model, place(high), {});
      keys.stay(0.1).to(0.8, place(0.005)).to(1.2, place(-0.02)).stay(2.2).to(3, place(high));
      tracks.push_back(keys.track());
      continue;
    }
    // The back of each hand looks away from the object; as low as what is under it lets the hands be.
    const Vec3 back = side * s.aside, face = (side > 0 ? wide[1] : wide[0]) * s.aside;
    const Vec3 middle = s.middle();
    const double most = s.extent(s.out)[1] - s.out.dot(middle);
    double lift = 0;
    const auto place = [&](double gap, double by = 0) {
      Palm palm{face + (gap + half) * back, Site::axes(s.along, back)};
      palm.position += s.along * s.along.dot(middle) + s.out * (s.out.dot(middle) + lift + by);
      return palm;
    };
    while (lift < most && !s.clear(place(0.015), {}, model)) lift += 0.005;
    const double high = s.clear_height(0.1, [&](double h) { return place(0.03, h); }, {}, model);
    Keyframes keys(model, place(0.03, high), {});
    keys.stay(0.1).to(0.8, place(0.02)).to(1.2, place(-0.015)).stay(1.5).to(2, place(-0.015, 0.05)).stay(2.4);
    keys.to(2.8, place(-0.015)).to(3.1, place(0.03)).to(3.6, place(0.03, high));
    tracks.push_back(keys.track());
  }
  return tracks;
}

// A tool that points where fingers would goes into the object from above, 1.5 mm and 2 degrees off its axis.
std::vector<Track> insert(const Site& s) {
  const Vec3 top = s.middle() + (s.extent(s.out)[1] - s.out.dot(s.middle())) * s.out;
  const auto place = [&](double height, double off, double tilt) {
    return Palm{top + height * s.out + off * s.along, rotation(tilt * s.aside) * Site::axes(-s.out, s.aside)};
  };
  Keyframes keys(hand::standard(), place(0.09, 0.003, 0), {});
  keys.stay(0.1).to(0.8, place(0.045, 0.003, 0.035)).to(2, place(0.005, 0.0015, 0.035)).stay(2.4);
  keys.to(3.2, place(0.045, -0.0015, -0.035)).to(3.8, place(0.09, 0, 0));
  return {keys.track()};
}

// Into the slot, a quarter turn behind it, back up against it, and out the way it came; 0.5 mm and 1 degree off.
std::vector<Track> unlock(const Site& s) {
  const auto place = [&](double height, double turn, double off = 5e-4, double tilt = 0.0175) {
    return Palm{Vec3(off, -off, height),
                rotation(turn * Vec3::UnitZ()) * rotation(tilt * Vec3::UnitX()) * Site::axes(-s.out, Vec3::UnitY())};
  };
  constexpr double quarter = 1.5707963;
  Keyframes keys(hand::standard(), place(0.05, 0, 0, 0), {});
  keys.stay(0.1).to(1.2, place(0.002, 0.03)).to(2, place(0.002, quarter)).to(2.4, place(0.03, quarter)).stay(2.6);
  keys.to(3, place(0.002, quarter)).to(3.8, place(0.002, 0)).to(4.8, place(0.05, 0, 0, 0));
  return {keys.track()};
}

// The palm, upright, goes 0.25 m along x at 0.4 m/s: from 60 mm before the first loose object to behind it.
std::vector<Track> push(const Site& s) {
  const auto box = std::ranges::find_if(s.about.objects, &Object::loose);
  if (box == s.about.objects.end()) throw std::invalid_argument(s.about.name + " has no loose object to push");
  const Mat3 upright{{0, 0, -1}, {-1, 0, 0}, {0, 1, 0}};
  const Vec3 start = box->pose.position - Vec3(0.06 + 0.014 + box->pieces[0].shape.half().x(), 0, 0);
  constexpr double speed = 0.4, way = 0.25;
  Track track{.model = hand::standard(), .patience = 1};
  track.keys.push_back({0, {{start, upright}}});
  for (const double time : {way / speed, way / speed + 0.5})
    track.keys.push_back({time, {{start + Vec3(way, 0, 0), upright}}});
  return {track};
}

struct Entry {
  const char* name;
  const char* line;
  std::vector<Track> (*make)(const Site&);
};
constexpr Entry entries[] = {
    {"press", "the flat hand pressed 30 mm into the surface", press},
    {"slide", "pressed 15 mm deep and moved 140 mm forth and back along the surface", slide},
    {"grasp", "the fingers closed about the object at the focus, then the hand up by 100 mm, down again and open",
     grasp},
    {"lift", "a loose object pinched between thumb and index finger, lifted by 0.2 m, carried 0.3 m, set down", lift},
    {"hold", "the same grip, kept for a minute", hold},
    {"push", "the upright palm moved 0.25 m at 0.4 m/s, a loose object before it", push},
    {"poke", "the index finger put 40 mm through the surface", poke},
    {"fist", "a fist clenched 25 mm inside the object", fist},
    {"swipe", "through the object and back at 5 m/s", swipe},
    {"teleport", "jumps of 0.3 m: one with the way clear, one through the surface and back", teleport},
    {"insert", "a tool (--god peg) into the object at the focus and out again, a little off its axis", insert},
    {"unlock", "a tool (--god key) through a slot, turned behind it, pulled, turned back and out", unlock},
    {"lost", "tracking lost for 0.3 s while sliding in contact", lost},
    {"nan", "NaN among the keys of a press: one, and four in a row", not_numbers},
    {"two_hands", "both hands, pressing the object between them or the surface side by side", two_hands}};

}  // namespace

std::vector<std::pair<std::string, std::string>> synthetic_motions() {
  return mapped(entries, [](const Entry& e) { return std::pair<std::string, std::string>(e.name, e.line); });
}

bool names_file(const std::string& motion) {
  if (motion.find_first_of("./") != std::string::npos) return true;
  return std::filesystem::is_regular_file(motion) &&
         std::ranges::find(entries, motion, &Entry::name) == std::end(entries);
}

HandMotion synthetic_motion(const std::string& name, const Surroundings& about) {
  const auto entry = std::ranges::find(entries, name, &Entry::name);
  if (entry == std::end(entries))
    throw std::invalid_argument("no motion '" + name + "'" + did_you_mean(name, names_of(entries, &Entry::name)) +
                                " (./zwang simulate --help lists all)");
  HandMotion motion{.name = name, .hands = entry->make(Site(about))};
  for (const Track& track : motion.hands) {
    motion.duration = std::max(motion.duration, track.keys.back().time);
    if (track.held_over > 0)
      motion.notes.push_back(std::to_string(track.held_over) + " keys lost or NaN, on purpose: held over");
  }
  return motion;
}

}  // namespace zwang::god
