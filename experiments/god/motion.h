#pragma once

#include <string>
#include <vector>

#include "bench/scenes/hand.h"

namespace zwang::god {

// Where one hand is tracked at one time: the joints are closed and the limits kept, since it is made of these.
struct Target {
  Pose<double> palm = {};    // m, world
  hand::Angles angles = {};  // rad
  bool tracked = true;       // false: the last pose that was tracked is held over
};

// One hand over time. Between keys the palm goes along the screw from one to the next and angles linearly; a pause
// between keys longer than `patience`, and times outside of them, count as lost tracking.
struct Track {
  struct Key {
    double time;  // s, ascending
    Target target;
  };

  hand::Model model = {};
  std::vector<Key> keys = {};
  double patience = 0.1;  // s
  double misfit_mean = 0,
         misfit_most = 0;     // m, joints of the retargeted hand against the raw recording; 0 if synthetic
  std::size_t held_over = 0;  // frames of the recording that were NaN, torn or without this hand

  Target at(double time) const;
};

// What the tracked hands do.
struct Motion {
  std::string name = {};
  std::vector<Track> hands = {};  // one or two
  double duration = 0;            // s
};

}  // namespace zwang::god
