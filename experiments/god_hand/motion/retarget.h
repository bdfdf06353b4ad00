#pragma once

#include <span>

#include <zwang/experiments/god_hand/motion/hand_motion.h>
#include <zwang/experiments/god_hand/motion/recording.h>

namespace zwang::god {

// The track of a hand that follows a recorded one within its joints and limits, key for key. Frames without a hand are
// held over (Track::held_over). Of the hand's measures bone lengths and the joints at the palm are the recording's, the
// directions of the straight fingers fitted to it, radii, masses and the palm's box the standard hand's, scaled; limits
// the standard hand's. Throws std::invalid_argument for a track without a hand in it.
Track retarget(const RecordedTrack& track);

// Where the pad of a phalanx is to lie: flat on a face.
struct Pad {
  int body;    // of hand::Poses
  Vec3 point;  // m, world: under the middle of the bone
  Vec3 into;   // unit, into the face
};

// The hand, as near to `near` as that leaves it, whose pads lie there: least squares over the palm and the angles
// within their limits. Throws std::invalid_argument where a pad is off by more than 2 mm.
Target with_pads(const hand::Model& model, const Target& near, std::span<const Pad> pads);

}  // namespace zwang::god
