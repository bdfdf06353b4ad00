#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include <zwang/core/model/pose.h>
#include <zwang/core/referee/measure.h>
#include <zwang/experiments/god_hand/hand/hand_shapes.h>

namespace zwang::god {

// Where a sub-step came from; of a frame, the last in this order that one of its sub-steps had.
//   free         no contact row pressed
//   constrained  the least constraint of the solve, whole
//   damped       shortened, since joints bend the linear step
//   bounded      shortened to what contacts were looked for in, or after a reversal
//   relaxed      rows that push out contradicted each other; they kept what gap there was
//   held         no part of the way was clear, or there was no answer: the last pose
//   limited      a solve met its limit under the law of friction; the step is that of a simpler law (FrameSolver)
enum class Origin { free, constrained, damped, bounded, relaxed, held, limited };
inline constexpr std::array origin_names = {"free", "constrained", "damped", "bounded", "relaxed", "held", "limited"};
constexpr const char* to_string(Origin origin) { return origin_names[static_cast<std::size_t>(origin)]; }

// A contact that was a row of the frame's last solve.
struct FrameContact {
  int body = 0, object = -1;     // god object; object of the surroundings, or -1 - other god object
  Vec3 point = Vec3::Zero();     // m, world, on the god object's surface at the frame's end
  Vec3 normal = Vec3::Zero();    // unit, toward the god object
  double gap = 0;                // m, when it became a row
  double push = 0;               // N, on the object: lambda k_f dt^2, capped
  Vec3 friction = Vec3::Zero();  // N, on the object, world
};

// Where the time of a frame went: thread CPU seconds.
struct StageTimes {
  double physics = 0, resolution = 0, assembly = 0, solve = 0;
  double search = 0, completion = 0, sweep = 0;  // near pairs and their rows; rows given back; times of contact
  double other = 0;
  double collision() const { return search + completion + sweep; }
  double total() const { return physics + resolution + assembly + solve + collision() + other; }
};

// Everything that is known of one simulated frame. Lengths in m, angles in rad.
struct Frame {
  long number = 0;
  double time = 0;                        // s
  std::vector<Pose<double>> target, god;  // of all god objects, hand after hand
  std::vector<Pose<double>> loose;        // of the loose objects, in the order of the surroundings
  std::vector<FrameContact> contacts;

  double gap = 1;            // smallest, of a god object to anything; negative: penetration
  double target_depth = 0;   // of the target's deepest body inside (0: outside)
  double separation = 0;     // largest gap of a joint
  double limit = 0;          // rad, largest violation of a joint limit
  double distance = 0;       // largest, of a god object to its target
  double lost_slide = 0;     // tangential motion lost at frictionless contacts in this frame, m
  double jitter = 0;         // largest second difference of a god object's position beyond its target's, m
  double work = 0;           // J, done on loose objects in this frame
  double impulse_error = 0;  // relative: impulse received by objects plus the hand's scaled one
  double object_speed = 0;   // m/s, fastest loose object that the hand touches
  double grip = 0;           // N, half the sum of the normal forces on the loose object that is held hardest
  double friction_used = 0;  // of the largest that a contact with a loose object could have: 1 where it slides
  double slip = 0;           // m/s, fastest of those contacts, along the surface
  double creep = 0;          // m/s, the same once all targets have stood still for half a second; else 0
  double late = 0;           // s, for which a loose object has been pressed though no target presses it any more
  std::vector<Vec<double, 6>> device = {};              // N, N m: what a haptic device would show at each god object
  Vec<double, 6> palm_wrench = Vec<double, 6>::Zero();  // the first of them
  int rows = 0, raw = 0, kept = 0, completed = 0, sub_steps = 0, returned = 0;  // returned: objects put back
  bool tracked = true, held = false, stuck = false, behind = false;  // behind: target through a thin part, hand not
  Origin origin = Origin::free;
  Status claimed = Status::unsolved;
  std::optional<Verdict> verified = {};  // of the worst solve of the frame; none: the referee did not look
  StageTimes times = {};

  void came_from(Origin sub_step) { origin = std::max(origin, sub_step); }
  bool touches() const { return gap <= hand::touching; }  // a god object touches something

  // Back to the beginning, with the storage kept.
  void reset() {
    Frame fresh;
    const auto keep = [](auto& from, auto& to) { from.clear(), to = std::move(from); };
    keep(target, fresh.target), keep(god, fresh.god), keep(loose, fresh.loose), keep(contacts, fresh.contacts);
    keep(device, fresh.device);
    *this = std::move(fresh);
  }
};

}  // namespace zwang::god
