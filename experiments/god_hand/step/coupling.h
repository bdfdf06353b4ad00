#pragma once

#include <span>
#include <vector>

#include <zwang/experiments/god_hand/step/cluster.h>
#include <zwang/experiments/god_hand/step/grasp.h>
#include <zwang/experiments/god_hand/step/physics.h>

namespace zwang::god {

// What the god objects' last step does to the loose objects in the engine's next one.
//
// The force. A contact's lambda, at k_s = 1/dt^2, is what holds a god object back from its target; as a force it would
// grow with the rate. lambda dt^2 [kg m], the mass held back times how far, does not: the push is F = lambda dt^2 k_f,
// a spring of k_f times the mass that hangs on the contact. All pushes of a hand on one object are scaled down together
// when their sum is above the cap.
//
// Its bound. A spring that is 50 mm tense throws a light box far faster than any hand moves. A hand can give a contact
// point no more than its own speed, so the impulses j of a step are bounded: with what the object would do without them
// (its velocity and gravity's share), no contact point may leave faster than
//
//   v = min(u + stretch / tau, 1.5 v_hand),    u: of the target at that point, along the push; tau = 0.1 s
//
// stretch being how far the target is beyond, v_hand the fastest that the target of any of the hand's bodies has lately
// gone (it fades in half a second; what is faster than Options::fastest is a jump of the tracking, not a hand).
// Contacts of an object act on each other: the bounded impulses are the solution of 0 <= j_i <= F_i dt, with (W j + v0
// - v)_i <= 0 where j_i > 0 can be lessened: projected Gauss-Seidel over the few contacts, those of both hands
// together. None of it knows of the rate but through the friction and gravity of one step.
//
// With friction the forces are those of grasp.h, which needs no bound: its damper is the same tau. The cap is the same.
//
// The god objects receive the same impulses, scaled as they are, with the other sign: nothing is lost between the two.
class Coupling {
 public:
  Coupling(const Surroundings& surroundings, const Options& options, std::span<const Cluster> clusters);

  // Before the step: how fast the targets go. `last`, `now`: of all god objects of a cluster.
  void aim(std::size_t cluster, PoseSpan last, PoseSpan now);

  // Before it, too: what else acted on an object in the engine's step [N; N m], beside gravity and wrenches().
  void observe(std::size_t object, const Vec<double, 6>& before, const Vec<double, 6>& after, const Mat3& rotation);

  // The clusters that hold something go with it, to where the engine has put the objects.
  void carry(std::span<Cluster> clusters, PoseSpan now) const;

  // After it: the wrenches of the next step, and the frame's contacts, work and errors.
  void push(std::span<const Cluster> clusters, const Physics* physics, Frame& frame);

  // N, N m about the centres of mass, by object.
  std::span<const Vec<double, 6>> wrenches() const { return memory_.wrench; }

  // What is kept from frame to frame.
  struct Memory {
    std::vector<double> hand_speed;      // m/s, by cluster
    std::vector<double> since, between;  // s, by cluster: since its targets last changed; between the last two changes
    std::vector<std::vector<Vec<double, 6>>> target_velocity;  // m/s, rad/s, by cluster and god object
    std::vector<Vec<double, 6>> wrench;
    std::vector<std::vector<Vec<double, 6>>> part;  // of the wrenches: by cluster, by object
  };
  Memory& memory() { return memory_; }
  std::span<Grasp> grasps() { return grasps_; }  // by cluster; none without friction
  void forget();                                 // warm starts

 private:
  struct Push {
    std::size_t cluster;
    BodyId body;
    std::size_t object, row, contact;  // row of the cluster's problem; number in Frame::contacts
    Vec3 lever, along;                 // m, from the object's centre of mass; unit, away from the hand
    double most, impulse;              // N s
    Vec<double, 6> given, received;    // N, N m: of the object, of the god object, about
    Vec3 object_at, god_at;            // m, world
    double bound, speed;               // m/s, of the contact point along the push: at most; without any push
    double ease;                       // 1/kg
  };
  void collect(std::span<const Cluster> clusters, const Physics* physics, Frame& frame);
  template <class Of, class Shrink>
  void cap(const Of& of, double most, const Shrink& shrink);
  void hold(std::span<const Cluster> clusters, const Physics& physics, Frame& frame);
  void bound(const Physics& physics);
  void add(std::span<const Cluster> clusters, Frame& frame);

  const Surroundings* surroundings_;
  Options options_;
  Memory memory_;
  std::vector<Vec<double, 6>> change_;          // of the objects' velocities
  std::vector<Grasp> grasps_;                   // by cluster
  std::vector<Vec<double, 6>> other_, others_;  // N, N m, by object: of the engine; and of other clusters
  std::vector<Push> pushes_;
};

}  // namespace zwang::god
