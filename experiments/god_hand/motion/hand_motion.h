#pragma once

#include <string>
#include <vector>

#include <zwang/bench/scenes/hand.h>

namespace zwang::god {

// Where one hand is tracked at one time: the joints are closed and the limits kept, since it is made of these.
struct Target {
  Pose<double> palm = {};    // m, world
  hand::Angles angles = {};  // rad
  bool tracked = true;       // false: the last pose that was tracked is held over
  // rad, by the hinge of a tool, where a path sets it; NaN: the tool's own drive does.
  std::vector<double> hinges = {};
};

// Finite, and not beyond any world: from 1e17 m no hand finds back.
inline bool is_usable(const Pose<double>& pose) { return pose.position.norm() <= 1e6 && pose.rotation.allFinite(); }

// A share of the way between two: the palm along the screw from one to the next, angles linearly.
Target part_of_way(const Target& from, const Target& to, double share);

// One hand over time. Between two tracked keys the palm goes along the screw from one to the next and angles linearly.
// Where a key is not tracked, in a whole pause between keys longer than `patience`, and at times outside of them,
// tracking is lost and the last tracked pose is held until the next tracked key is there.
struct Track {
  struct Key {
    double time;    // s, ascending
    Target target;  // finite, also where it is not tracked
  };

  hand::Model model = {};
  std::vector<Key> keys = {};
  double patience = 0.1;  // s
  double misfit_mean = 0,
         misfit_most = 0;     // m, joints of the retargeted hand against the raw recording; 0 if synthetic
  std::size_t held_over = 0;  // frames of the recording that were NaN, torn or without this hand
  double beyond = 0;          // rad, the farthest that joint angles of the recording were outside the limits

  Target at(double time) const;
};

// The next key of a track. What is not tracked, not finite or more than a kilometre away becomes the last pose, not
// tracked, and is counted as held over; before the first tracked key it is only counted.
void append(Track& track, Track::Key key);

// What the tracked hands do.
struct HandMotion {
  std::string name = {};
  std::vector<Track> hands = {};        // one or two
  double duration = 0;                  // s
  std::vector<std::string> notes = {};  // what of the recording was passed over or held, one line each
};

}  // namespace zwang::god
