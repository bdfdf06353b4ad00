#pragma once

#include <zwang/experiments/god_hand/motion/hand_motion.h>
#include <zwang/experiments/god_hand/motion/recording.h>

namespace zwang::god {

// The measures of a recorded hand. Bone lengths and the joints at the palm are the recording's, the directions of the
// straight fingers fitted to it, radii, masses and the palm's box the standard hand's, scaled; limits the standard
// hand's. Throws std::invalid_argument for a track without a hand in it.
hand::Model fit_model(const RecordedTrack& track);

// The track of a hand of these measures that follows a recorded one within its joints and limits, key for key. Frames
// without a hand are held over (Track::held_over).
Track retarget(const RecordedTrack& track, const hand::Model& model);

}  // namespace zwang::god
