#pragma once

#include <functional>
#include <limits>
#include <vector>

#include <zwang/experiments/god_hand/measure/columns.h>
#include <zwang/experiments/god_hand/motion/hand_motion.h>
#include <zwang/experiments/god_hand/simulation.h>
#include <zwang/experiments/questions/question.h>

namespace zwang::questions {

// The run of a question was cut short by Ctrl-C.
struct Interrupted {};

// A motion by name about the surroundings, or a recording placed among them; `asking.motion` goes before `name`.
god::HandMotion motion_for(const std::string& name, const god::Surroundings& about, const Asking& asking);

// Calls step(k) for the frames of a motion, k = 1, 2, ..., until it is over or step() returns false. Throws
// Interrupted.
void each_frame(const god::HandMotion& motion, double dt, const Asking& asking, const std::string& what,
                const std::function<bool(long k)>& step);

// Simulates the motion and keeps every frame, up to `contact` seconds after the first one with contacts. Throws
// Interrupted.
std::vector<god::Frame> play(const god::Surroundings& surroundings, const god::HandMotion& motion,
                             const god::Options& options, const Asking& asking, const std::string& what,
                             double contact = std::numeric_limits<double>::infinity());

// Of the frames' times [s].
struct Rates {
  double median, mean, least;  // Hz; mean: frames over the whole time; least: of the slowest frame
  double collision;            // share of the whole time
};
Rates rates(const std::vector<god::Frame>& frames);

// One value a frame as series of a chart: where there are more than 600 frames, the median and the largest of each of
// 600 stretches, as "NAME" and "NAME, largest".
void add_series(Chart& chart, const std::string& name, const std::vector<god::Frame>& frames,
                const std::function<double(const god::Frame&)>& value);

// The farthest that a god object of one run is from the same in the other, in any frame that both have [m].
double farthest(const std::vector<god::Frame>& a, const std::vector<god::Frame>& b);

// In every frame of a run under `options`, its state is also taken one frame on under `other`: the farthest that a god
// object then is from the same one of the run [m], by frame. Both need the same clusters. Throws Interrupted.
std::vector<double> apart_within_frames(const god::Surroundings& surroundings, const god::HandMotion& motion,
                                        const god::Options& options, const god::Options& other, const Asking& asking,
                                        const std::string& what);

std::string number(double value, int digits = 3);  // "1,234", "0.0123", "1.2e-09"

}  // namespace zwang::questions
