#pragma once

#include <span>

#include <zwang/core/model/assemble.h>
#include <zwang/experiments/god_hand/scenes/surroundings.h>
#include <zwang/experiments/god_hand/step/cluster.h>
#include <zwang/experiments/god_hand/step/frame_solver.h>
#include <zwang/experiments/god_hand/step/physics.h>

namespace zwang::god {

inline constexpr double coupling_time = 0.1;  // s, tau

// The god objects of a cluster and the loose objects that they touch, as one problem with friction: the forces between
// them in the engine's next step.
//
// A god object has no inertia of its own here. It hangs on its target by a spring and a damper,
//
//   k_f M (x_target - x) + tau k_f M (v_target - v),
//
// so that what it pushes goes no faster than (x_target - x) / tau beyond its target. An object has its inertia, and
// moves on with its velocity, gravity and what else acted on it in the last step: a floor, other objects, another hand.
// One implicit step of length dt, in displacements, is the least constraint again:
//
//   minimize  k_f (1 + tau / dt) / 2 |d - d^|^2_M over the god objects  +  1 / (2 dt^2) |d - d^|^2_M over the objects
//
// under the rows of joints, limits and contacts, Coulomb's law on the slip between the two sides. At rest d = 0 and the
// forces are those of the springs, whatever the rate; the motion of the objects that they give is the one that the god
// objects' own step follows.
//
// Over soft pads the normal rows are soft, and what is solved for are the bones: they go into their pads by force /
// stiffness. What everybody else sees are the outsides of the pads, which enter nothing: the motion nearest to the
// bones' that keeps the gaps, beside objects that move as was found. The bones' lead over it is remembered, for
// otherwise the damper would see it as speed in each step anew.
class Grasp {
 public:
  Grasp(const Scene& scene, const Surroundings& surroundings, const Options& options);

  // From where the god objects are now. target_velocity: by god object, [m/s; rad/s]. others: by object, [N; N m].
  // False where there is no answer.
  bool solve(const Cluster& cluster, std::span<const Vec<double, 6>> target_velocity, const Physics& physics,
             std::span<const Vec<double, 6>> others, double seconds);
  bool limited() const { return grip_.solver.limited() || outside_.solver.limited(); }
  // What the last solve says of the next step: the motion of the god objects [m, rad], and the objects they press on.
  // Empty where there was no answer.
  std::span<const Vec<double, 6>> motion() const { return motion_; }
  std::span<const std::size_t> held() const { return held_; }
  std::span<const Vec<double, 6>> lead() const { return lead_; }
  void let_go();
  // The same as numbers, as many each time, for a checkpoint.
  struct Hold {
    std::vector<Vec<double, 6>> motion;  // by god object
    std::vector<double> objects;         // by object: 1 where it is held, else 0
    std::vector<Vec<double, 6>> lead;    // by god object: of the bones, over the outsides of their pads
  };
  Hold hold() const;
  void take(const Hold& hold);
  void forget() { grip_.solver.forget(), outside_.solver.forget(); }  // warm starts
  // The force of a contact row of the cluster on the object and on the god object, about their centres of mass [N; N
  // m].
  void read(std::size_t row, Vec<double, 6>& on_object, Vec<double, 6>& on_god) const;

 private:
  struct Solve {
    explicit Solve(const Options& options) : solver(options) {}
    Assembler assembler;
    FrameSolver solver;
    Problem problem;
    Solution solution;
  };
  void write_contacts(const Cluster& cluster);
  void free_objects(const Cluster& cluster, const Physics& physics, std::span<const Vec<double, 6>> others);
  void stay_outside(const Cluster& cluster, double seconds);

  const Surroundings* surroundings_;
  Options options_;
  double share_;    // of the multipliers, what is force
  Index gods_ = 0;  // unknowns of the god objects: the first ones
  Scene scene_;
  Solve grip_, outside_;  // outside_: of the pads
  Vector z_u_;
  std::vector<Vec<double, 6>> wanted_;  // m/s^2, rad/s^2, by free body
  std::vector<Index> row_at_;
  std::vector<Vec<double, 6>> motion_, lead_;
  std::vector<std::size_t> held_;
};

}  // namespace zwang::god
