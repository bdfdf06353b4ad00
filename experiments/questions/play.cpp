#include <zwang/experiments/questions/play.h>

#include <algorithm>
#include <cmath>

#include <zwang/bench/results/statistics.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/tools/play.h>

namespace zwang::questions {

god::HandMotion motion_for(const std::string& name, const god::Surroundings& about, const Asking& asking) {
  const std::string& wanted = asking.motion.empty() ? name : asking.motion;
  if (!std::filesystem::exists(wanted)) return god::synthetic_motion(wanted, about);
  god::HandMotion motion = god::read_motion(wanted);
  god::place(motion, about);
  return motion;
}

namespace {

double farthest(const god::Frame& a, const god::Frame& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.god.size(); ++i) most = std::max(most, (a.god[i].position - b.god[i].position).norm());
  return most;
}

}  // namespace

void each_frame(const god::HandMotion& motion, double dt, const Asking& asking, const std::string& what,
                const std::function<bool(long)>& step) {
  const double seconds = asking.seconds > 0 ? std::min(asking.seconds, motion.duration) : motion.duration;
  const long frames = std::lround(seconds / dt);
  Progress bar(asking.terminal);
  for (long k = 1; k <= frames && step(k); ++k) {
    if (k % 32 == 0) bar.show(static_cast<double>(k) / static_cast<double>(frames), what, -1);
    if (asking.interrupted != nullptr && *asking.interrupted) throw Interrupted{};
  }
}

std::vector<god::Frame> play(const god::Surroundings& surroundings, const god::HandMotion& motion,
                             const god::Options& options, const Asking& asking, const std::string& what,
                             double contact) {
  god::Play play(surroundings, motion, options);
  std::vector<god::Frame> frames;
  double last = std::numeric_limits<double>::infinity();
  each_frame(motion, options.dt, asking, what, [&](long k) {
    frames.push_back(play.step(k));
    if (frames.back().kept > 0) last = std::min(last, frames.back().time + contact);
    return frames.back().time <= last;
  });
  return frames;
}

std::vector<double> apart_within_frames(const god::Surroundings& surroundings, const god::HandMotion& motion,
                                        const god::Options& options, const god::Options& other, const Asking& asking,
                                        const std::string& what) {
  god::Play one(surroundings, motion, options), two(surroundings, motion, other);
  std::vector<double> apart;
  each_frame(motion, options.dt, asking, what, [&](long k) {
    two.simulation().restore(one.simulation().checkpoint());
    apart.push_back(farthest(one.step(k), two.step(k)));
    return true;
  });
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
  return {1 / median(times), static_cast<double>(frames.size()) / whole,
          1 / *std::max_element(times.begin(), times.end()), collision / whole};
}

void add_series(Chart& chart, const std::string& name, const std::vector<god::Frame>& frames,
                const std::function<double(const god::Frame&)>& value) {
  constexpr std::size_t most = 600;
  const std::size_t stretch = std::max<std::size_t>(1, (frames.size() + most - 1) / most);
  std::vector<Point> largest;
  for (std::size_t begin = 0; begin < frames.size(); begin += stretch) {
    std::vector<double> values;
    for (std::size_t k = begin; k < std::min(begin + stretch, frames.size()); ++k) values.push_back(value(frames[k]));
    chart.points.push_back({name, frames[begin].time, median(values)});
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
    return text += grouped(std::llround(std::abs(value)));
  }
  const bool far = value != 0 && (std::abs(value) < 1e-3 || std::abs(value) >= 1e7);
  return printed(far ? "%.*e" : "%.*g", far ? digits - 1 : digits, value);
}

}  // namespace zwang::questions
