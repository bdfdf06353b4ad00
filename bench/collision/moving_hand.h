#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <zwang/bench/collision/audit.h>

namespace zwang {

// What one frame of a moving hand cost and did. Times are thread CPU seconds.
struct HandFrame {
  double search = 0;                     // s: what is near, and what of it becomes rows
  double completion = 0;                 // s: rows given back after a solve
  double sweep = 0;                      // s: times of contact
  double whole = 0;                      // s: everything, the solves included
  int raw = 0, kept = 0, completed = 0;  // contacts found, kept as rows, given back
  int sub_steps = 0;                     // 1 where nothing was in the way
  bool held = false;                     // the hand kept its pose
  double collision() const { return search + completion + sweep; }
};

// A hand that moves among obstacles: what the collision suite times and audits. The suite knows no hand of its own;
// the program registers those that it has.
class MovingHand {
 public:
  // Called with every motion that is committed: all bodies go straight from one pose to the other,
  // retract(from, s * twist_between(from, to)).
  using Watch = std::function<void(std::span<const Pose<double>> from, std::span<const Pose<double>> to)>;

  virtual ~MovingHand() = default;
  virtual const std::vector<collision::Shape>& shapes() const = 0;  // of the bodies
  virtual const std::vector<Obstacle>& obstacles() const = 0;
  virtual void watch(Watch watch) = 0;
  virtual HandFrame step() = 0;

  // Now.
  virtual std::span<const Pose<double>> poses() const = 0;
  virtual std::span<const Pose<double>> obstacle_poses() const = 0;
};

// Where hands move, one run for each speed.
struct HandScene {
  std::string name;            // "1M triangles, 20 parts"
  std::string parts;           // "real" or "procedural", and of what
  std::vector<double> speeds;  // m/s, of the target
  double spin = 0;             // rad a frame, of the target
  int frames = 1000;           // of each run; twice as many with friction
  // Makes the scene. What it returns starts a hand in it at one of the speeds, with friction or without,
  // and keeps the scene.
  using Start = std::function<std::unique_ptr<MovingHand>(double speed, bool friction)>;
  std::function<Start()> load;
};

}  // namespace zwang
