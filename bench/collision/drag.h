#pragma once

#include <array>
#include <functional>
#include <memory>
#include <span>

#include <zwang/bench/scenes/hand.h>
#include <zwang/collision/manifold.h>
#include <zwang/collision/world.h>
#include <zwang/core/model/motion.h>
#include <zwang/core/problem/solver.h>

namespace zwang {

// A mesh of a scene that hands are dragged over.
struct Part {
  std::shared_ptr<const collision::Tree> tree;
  Pose<double> pose = {};
  Vec<double, 6> velocity = Vec<double, 6>::Zero();  // m/s, rad/s, to and fro: times cos(2 pi t / 1 s)
};

struct DragOptions {
  double dt = 1e-3;     // s
  double speed = 0.5;   // m/s, of the target on its way over the parts
  double spin = 0;      // rad per frame, of the target about its own vertical, to and fro
  double depth = 0.03;  // m, of the target's palm below where the palm rests
  // The share of their range to which fingers close, about a bar along x on which the hand is dragged to and fro; 0:
  // over a surface, curling and stretching.
  double grip = 0;
  double gap = 2e-4;         // m, that contact rows keep
  double activation = 2e-3;  // m, at least; the motion of a frame when that is more
  int sub_steps = 3;
  bool lazy = true;    // complete the manifold after each solve
  bool reduce = true;  // false: every raw contact becomes a row
};

// What one frame cost and did. Times are thread CPU seconds of the collision calls alone.
struct DragFrame {
  double touches = 0, manifold = 0, toc = 0;  // s
  int raw = 0, kept = 0;                      // contacts, of the frame's first sub-step
  int touching = 0;                           // bodies nearer than 0.5 mm to a part at the frame's end
  int truncations = 0;                        // sub-steps that ended at a time of contact
  int completed = 0;                          // contacts that lazy completion gave back
  bool held = false;                          // motion was left after the last sub-step
  bool overlap = false;
  double gap = 1;     // m, smallest at the frame's end
  double change = 0;  // largest motion of a body [m] that lazy completion took back
  double seconds() const { return touches + manifold + toc; }
};

// The bench's hand as a god object: palm a rounded box, phalanxes capsules. Its target runs over the parts with the
// palm pressed `depth` below their highest points and the fingers curling, or along a bar that they are closed about;
// each frame z = dual_active_set(couple to targets, joints, limits, contacts) moves the hand as far as the time of
// contact allows.
class HandDrag {
 public:
  HandDrag(std::vector<Part> parts, const DragOptions& options);

  DragFrame step();
  const collision::World& world() const { return world_; }
  // Colliders: first the hand's 16 bodies, then the parts.
  std::span<const collision::Shape> shapes() const { return shapes_; }
  const std::vector<Part>& parts() const { return parts_; }
  // Called with every motion that is committed, before it is: the poses between may be looked at.
  std::function<void(std::span<const collision::Move> moves, double time)> watch = {};

 private:
  struct Stage {
    Vec3 middle, reach;  // m
  };
  Stage stage(double way) const;
  void aim();
  double rest(const Vec3& at, const Mat3& axes);
  double limited_coupling();
  bool solve();
  void write_rows(bool push);
  void sub_step(double share, DragFrame& frame);

  DragOptions options_;
  std::vector<Part> parts_;
  std::vector<collision::Shape> shapes_;
  collision::World world_;
  collision::World ground_;  // the parts and, last, a palm that is let down on them
  collision::Manifold manifold_;
  Scene scene_;
  Assembler assembler_;
  AnySolver solver_;
  Problem problem_;
  Solution solution_;
  WarmStart warm_;
  Vector z_u_;
  std::vector<Pose<double>> target_;
  std::vector<Vec<double, 6>> twist_;
  std::vector<collision::Move> moves_;
  std::span<const collision::Touch> touches_;
  Vec3 low_, high_;  // m, of the parts
  long frame_ = 0;
  double phase_ = 0;  // rad, of the target on its curve
  double toc_ = 1;
};

}  // namespace zwang
