#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <zwang/experiments/god_hand/motion/hand_motion.h>
#include <zwang/experiments/god_hand/scenes/surroundings.h>

namespace zwang::god {

// Where the target of the hand is at a time [s], at a speed [m/s].
using Course = std::function<Target(double time, double speed)>;

// Where the hand moves in the collision suite, one run for each speed.
struct HandScene {
  std::string name;            // "1M triangles, 20 parts"
  std::string parts;           // "real" or "procedural", and of what
  std::vector<double> speeds;  // m/s, of the target
  int frames;                  // of each run; twice as many with friction
  std::function<Surroundings()> make;
  std::function<Course(const Surroundings&)> course;
  double spin = 0;  // rad a frame, of the target
};

// The scenes of `./zwang simulate`, and some that are hard for collision queries. `data`: real parts; procedural ones
// stand in where they are absent.
std::vector<HandScene> hand_scenes(const std::filesystem::path& data);

// A run of a moving hand: figures over its frames. Times [s] are thread CPU time of the collision calls, but for
// `whole`.
struct HandStudy {
  std::string scene, parts;
  double speed = 0, spin = 0;
  std::size_t triangles = 0, pieces = 0;
  double bytes_per_triangle = 0;
  int frames = 0;
  double median = 0, touching_median = 0, p95 = 0, p99 = 0, worst = 0;
  double whole_median = 0, whole_p99 = 0;         // s, of everything that a frame does
  double touches = 0, manifold = 0, toc = 0;      // s, means: search for contacts, rows given back, times of contact
  double raw = 0, kept = 0, most_raw = 0;         // contacts per frame
  long truncations = 0, held = 0, completed = 0;  // truncations: sub-steps that go on after a time of contact
  long overlaps = 0;                              // frames that end with a gap that is not positive
  double gap = 1;                                 // m, the smallest at a frame's end
  long body_frames = 0, touching = 0;             // touching: nearer than hand::touching
  long audited = 0, penetrations = 0;             // poses, those between frames included; of these: that overlap
  double seconds = 0;                             // wall clock, all in
};

// timed: without friction, alone. Else FCL sees every committed pose, and as many between two as keep the steps below a
// body's radius.
enum class HandRun { timed, audited, audited_with_friction };
// surroundings: those that scene.make() made.
HandStudy study_hand(const HandScene& scene, const Surroundings& surroundings, double speed, HandRun run);

}  // namespace zwang::god
