#pragma once

#include <span>
#include <vector>

#include <zwang/constraints/contact.h>
#include <zwang/core/model/assemble.h>
#include <zwang/experiments/god_hand/hand/god_objects.h>
#include <zwang/experiments/god_hand/hand/skeleton.h>
#include <zwang/experiments/god_hand/scenes/surroundings.h>
#include <zwang/experiments/god_hand/step/contacts.h>
#include <zwang/experiments/god_hand/step/frame.h>
#include <zwang/experiments/god_hand/step/frame_solver.h>
#include <zwang/experiments/god_hand/step/options.h>

namespace zwang::god {

// One cluster of god objects among the objects: section 4 of the paper, with the corrections of docs/formulation.md.
//
// A sub-step. Contacts within `activation` become rows that keep a gap; z = the least constraint against
// z_u = k_s (target - god), k_s = 1/dt^2. Where no contact presses, the targets themselves are the candidate: they
// satisfy joints and limits, so that the target is reached in one step whatever the rotations. Otherwise it is the end
// of the linear step, put onto joints and limits; that step is kept within what the activation distance has seen, by
// scaling the motion, not z_u: a hand that slides loses nothing of a motion that is small, however deep its target is.
// The way to the candidate is swept, body by body, and at a time of contact below 1 the candidate is taken at that part
// of the way and swept again (the commit cycle). Only a pose whose way was clear is ever taken.
class Cluster {
 public:
  Cluster(GodObjects objects, const Surroundings& surroundings, const Options& options);

  std::size_t size() const { return objects_.shapes.size(); }
  const GodObjects& objects() const { return objects_; }
  const Skeleton& skeleton() const { return skeleton_; }
  PoseSpan poses() const { return pose_; }
  PoseSpan targets() const { return std::span(target_).first(size()); }

  // Poses of all god objects, put onto joints and limits. Forgets what earlier frames left behind.
  void place(PoseSpan poses);

  // What the next sub-step tries first: the targets themselves; the linear step, if a contact presses, since the last
  // one was blocked; or the linear step, since almost nothing was left of the straight way.
  enum class Next { straight, linear_if_pressed, linear };

  // What is kept from frame to frame, but for what makes it faster: restore() forgets that.
  struct Memory {
    std::vector<Pose<double>> pose, target;
    std::vector<Vec<double, 6>> last_step;
    std::vector<Pose<double>> followed;  // by object
    std::vector<Pose<double>> met_at;
    Next next;
    double step_scale;
  };
  Memory memory() const;
  void restore(const Memory& memory);
  void place_object(std::size_t object, const Pose<double>& pose);
  // The smallest gap to anything or between two of them [m]; `reach` where there is none below that.
  double gap(double reach) { return contacts_.gap(reach); }

  // Would the way straight to the targets be clear?
  bool way_is_clear();

  // A frame's first word: by how much bones lead over the outsides of their pads (Grasp), and so would be nearer to
  // the targets than the god objects are [m, rad; by god object].
  void set_lead(std::span<const Vec<double, 6>> lead) {
    std::copy(lead.begin(), lead.end(), lead_.begin());
    before_carried_.clear();
  }
  // Along with what it holds: one step of all of them [m, rad; by god object], while the engine has moved the objects
  // from where they are for the cluster to `now` (by object). Nothing where that way is not clear.
  void carry(std::span<const Vec<double, 6>> motion, std::span<const std::size_t> held, PoseSpan now);
  // To where it was before it was carried. False where it was not, in this frame.
  bool put_back();

  // A frame: where the god objects are tracked.
  void aim(PoseSpan targets);
  // A sub-step in two halves: the time of contact of what it would do; then doing it up to a time, at most that one.
  double propose(Frame& frame);
  void commit(double toc, Frame& frame);
  bool done() const { return done_; }

  // Of the frame's last solve.
  std::span<const Contacts::Row> rows() const { return contacts_.rows(); }
  double lambda(std::size_t row) const;  // N, of a contact row
  Vec3 friction(std::size_t row) const;  // N, on the god object, world
  int object_of(int collider) const { return contacts_.object_of(collider); }
  Vec<double, 6> contact_row(std::size_t row, BodyId body) const;  // of J, a god object's part
  PoseSpan solved_at() const { return solved_at_; }                // where the god objects stood then
  const Problem& problem() const { return problem_; }
  // The contacts that the last problem was written from.
  const ConstraintListOf<Contact>& contacts() const { return *written_; }
  bool held() const { return held_; }

 private:
  // The way of a sub-step, line 4 of Algorithm 1: none, where the solve has no answer; straight to the targets; a leg
  // of that, with more to go; the linear step.
  enum class Way { none, straight, leg, linear };

  void stand_at(PoseSpan poses);
  bool printed() const { return options_.commit == Options::Commit::printed; }
  bool met() const { return options_.rows == Options::Rows::met; }
  bool may_go_straight(bool pressing) const;
  void find_rows(double reach, Frame& frame);
  void write_rows(bool push);
  bool solve(Frame& frame);
  void take_solution();
  bool solve_lazily(Frame& frame);
  bool presses() const;
  double longest(std::span<const Vec<double, 6>> ways) const;  // m, that a point of a god object goes at most
  double constraint(PoseSpan poses, std::span<const Vec<double, 6>> less) const;
  void damp(Frame& frame);
  void slow_down();
  void bound();
  bool go_freely();
  void candidate(double part, Frame& frame);
  double sweep(Frame& frame);

  const Options options_;
  GodObjects objects_;
  Skeleton skeleton_;
  Contacts contacts_;
  const ConstraintListOf<Contact>* written_ = nullptr;
  Assembler assembler_;
  FrameSolver solver_;
  Problem problem_;
  Solution solution_;
  Vector z_u_;
  std::vector<Pose<double>> along_;  // of the god objects, had they moved with an object as one body
  std::vector<Pose<double>> pose_, target_, end_,
      solved_at_;                           // target_: of all bodies of the scene, as assembly wants it
  std::vector<Pose<double>> followed_;      // by object: up to where the god objects that touch it have moved with it
  std::vector<Index> row_at_;               // of each contact: its row in the problem
  std::vector<Vec<double, 6>> step_;        // m, rad: to the candidate
  std::vector<Vec<double, 6>> swept_step_;  // m, rad: to the present end, by god object
  std::vector<Pose<double>> before_carried_, before_followed_;  // empty: not carried, in this frame
  std::vector<Vec<double, 6>> lead_;                            // m, rad
  std::vector<Vec<double, 6>> last_step_;                       // m, rad: that was gone last
  std::vector<Pose<double>> met_at_;  // at the last time of contact, where rows are of what was met; else none
  double largest_step_ = 0;           // m, the most that a pressing cluster moves in a sub-step
  double minimum_step_ = 0;           // m, that it always may
  double step_scale_ = 1;             // part of it that it may after it turned back or was held
  double share_ = 1;                  // of what the solve says: step_
  Way way_ = Way::none;
  Next next_ = Next::straight;
  Origin origin_ = Origin::free;          // of the sub-step
  bool solved_ = false, pushed_ = false;  // there is an answer; of rows that push out to the whole gap
  bool done_ = false, held_ = false;      // the frame is over; the last sub-step kept its pose
  bool counted_ = false;                  // contacts of this frame, at its first look
  int sub_step_ = 0;
};

}  // namespace zwang::god
