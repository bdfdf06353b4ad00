#pragma once

#include <vector>

#include <zwang/experiments/god_hand/motion/hand_motion.h>
#include <zwang/experiments/god_hand/scenes/site.h>

namespace zwang::god {

// Motions in which friction holds a loose object, the one nearest to the focus. They throw std::invalid_argument where
// there is none, or none that the hand reaches around.

// Pinched between thumb and index finger, lifted by 0.2 m, carried 0.3 m toward the focus, set down and let go.
std::vector<Track> lift(const Site& site);
// The same grip, kept for a minute at 0.1 m.
std::vector<Track> hold(const Site& site);

}  // namespace zwang::god
