#include <zwang/experiments/questions/play.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <zwang/bench/collision/hand_shapes.h>
#include <zwang/bench/report/tables/statistics.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/experiments/god_hand/motion/motions.h>

namespace zwang::questions {

god::HandMotion motion_for(const std::string& name, const god::Surroundings& about, const Asking& asking) {
  const std::string& wanted = asking.motion.empty() ? name : asking.motion;
  if (!std::filesystem::exists(wanted)) return god::synthetic_motion(wanted, about);
  god::HandMotion motion = god::read_motion(wanted);
  god::place(motion, about);
  return motion;
}

namespace {

// What a motion asks of simulations: hands, their start, and targets by frame.
struct Course {
  Course(const god::HandMotion& motion_, const Asking& asking, double dt_) : motion(motion_), dt(dt_) {
    for (const god::Track& hand : motion.hands) {
      models.push_back(hand.model);
      targets.push_back(hand.at(0));
    }
    const double seconds = asking.seconds > 0 ? std::min(asking.seconds, motion.duration) : motion.duration;
    frames = std::lround(seconds / dt);
  }

  void aim(long frame) {
    for (std::size_t h = 0; h < targets.size(); ++h) targets[h] = motion.hands[h].at(static_cast<double>(frame) * dt);
  }

  const god::HandMotion& motion;
  double dt;
  long frames;
  std::vector<hand::Model> models;
  std::vector<god::Target> targets;
};

double farthest(const god::Frame& a, const god::Frame& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.god.size(); ++i) most = std::max(most, (a.god[i].position - b.god[i].position).norm());
  return most;
}

}  // namespace

std::vector<god::Frame> play(const god::Surroundings& surroundings, const god::HandMotion& motion,
                             const god::Options& options, const Asking& asking, const std::string& what,
                             double contact) {
  Course course(motion, asking, options.dt);
  god::Simulation simulation(surroundings, course.models, course.targets, options);
  std::vector<god::Frame> frames;
  frames.reserve(static_cast<std::size_t>(course.frames));
  double last = std::numeric_limits<double>::infinity();
  Progress bar(asking.terminal);
  for (long k = 1; k <= course.frames; ++k) {
    course.aim(k);
    frames.push_back(simulation.step(course.targets));
    if (frames.back().kept > 0) last = std::min(last, frames.back().time + contact);
    if (frames.back().time > last) break;
    if (k % 32 == 0) bar.show(static_cast<double>(k) / static_cast<double>(course.frames), what, -1);
    if (asking.interrupted != nullptr && *asking.interrupted) throw Interrupted{};
  }
  return frames;
}

std::vector<double> apart_within_frames(const god::Surroundings& surroundings, const god::HandMotion& motion,
                                        const god::Options& options, const god::Options& other, const Asking& asking,
                                        const std::string& what) {
  Course course(motion, asking, options.dt);
  god::Simulation one(surroundings, course.models, course.targets, options),
      two(surroundings, course.models, course.targets, other);
  std::vector<double> apart;
  Progress bar(asking.terminal);
  for (long k = 1; k <= course.frames; ++k) {
    two.restore(one.checkpoint());
    course.aim(k);
    apart.push_back(farthest(one.step(course.targets), two.step(course.targets)));
    if (k % 32 == 0) bar.show(static_cast<double>(k) / static_cast<double>(course.frames), what, -1);
    if (asking.interrupted != nullptr && *asking.interrupted) throw Interrupted{};
  }
  return apart;
}

Rates rates(const std::vector<god::Frame>& frames) {
  std::vector<double> times;
  double whole = 0, collision = 0;
  for (const god::Frame& f : frames) {
    times.push_back(f.times.total());
    whole += f.times.total();
    collision += f.times.collision();
  }
  return {1 / report::median(times), static_cast<double>(frames.size()) / whole,
          1 / *std::max_element(times.begin(), times.end()), collision / whole};
}

std::size_t touching(const std::vector<god::Frame>& frames) {
  return static_cast<std::size_t>(
      std::count_if(frames.begin(), frames.end(), [](const god::Frame& f) { return f.gap < hand::touching; }));
}

void add_series(Chart& chart, const std::string& name, const std::vector<god::Frame>& frames,
                const std::function<double(const god::Frame&)>& value) {
  constexpr std::size_t most = 600;
  const std::size_t stretch = std::max<std::size_t>(1, (frames.size() + most - 1) / most);
  std::vector<Point> largest;
  for (std::size_t begin = 0; begin < frames.size(); begin += stretch) {
    std::vector<double> values;
    for (std::size_t k = begin; k < std::min(begin + stretch, frames.size()); ++k) values.push_back(value(frames[k]));
    chart.points.push_back({name, frames[begin].time, report::median(values)});
    largest.push_back({name + ", largest", frames[begin].time, *std::max_element(values.begin(), values.end())});
  }
  if (stretch > 1) chart.points.insert(chart.points.end(), largest.begin(), largest.end());
}

double farthest(const std::vector<god::Frame>& a, const std::vector<god::Frame>& b) {
  double most = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) most = std::max(most, farthest(a[k], b[k]));
  return most;
}

std::string number(double value, int digits) {
  if (std::abs(value) >= std::pow(10, digits - 1) && std::abs(value) < 1e7) {
    std::string text = value < 0 ? "-" : "";
    return text += grouped(static_cast<std::size_t>(std::llround(std::abs(value))));
  }
  char text[32];
  const bool far = value != 0 && (std::abs(value) < 1e-3 || std::abs(value) >= 1e7);
  std::snprintf(text, sizeof text, far ? "%.*e" : "%.*g", far ? digits - 1 : digits, value);
  return text;
}

}  // namespace zwang::questions
