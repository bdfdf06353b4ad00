#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <zwang/experiments/god_hand/motion/hand_motion.h>
#include <zwang/experiments/god_hand/scenes/surroundings.h>

namespace zwang::god {

// A Leap recording (.json, also .gz) or joint angles (.csv), retargeted: z up, metres, in its own place. Throws
// BadFile, one line: file, frame or line, what was expected.
HandMotion read_motion(const std::filesystem::path& file);

// A motion made by formula, about the surroundings' focus: press, slide, grasp, poke, fist, swipe, teleport, lost, nan.
// Throws std::invalid_argument with the nearest name.
HandMotion synthetic_motion(const std::string& name, const Surroundings& about);
std::vector<std::pair<std::string, std::string>> synthetic_motions();  // name, one line
// Whether a word is a motion's file: it has a dot or a slash, or there is such a file and no such name.
bool names_file(const std::string& motion);

// Moves a recording to where it works: turned and shifted so that it goes on about the focus, and lowered until the
// hand would be inside an object that stays where it is in `share` of its frames and at some time 12 mm deep.
struct Placement {
  double inside = 0;  // share of the frames in which the target is inside or touches
  double depth = 0;   // m, the deepest
};
Placement place(HandMotion& motion, const Surroundings& about, double share = 0.45);

}  // namespace zwang::god
