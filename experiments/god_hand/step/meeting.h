#pragma once

#include <span>
#include <vector>

#include <zwang/experiments/god_hand/step/cluster.h>

namespace zwang::god {

// Two hands that may touch each other: they are clusters of their own (section 5 of the paper) until one is about to
// come near the other, and one cluster from then on until they are apart again.
class Meeting {
 public:
  // `both`: the same god objects as the two hands have, hand after hand, which meet each other.
  Meeting(GodObjects both, std::size_t first_hand, const Surroundings& surroundings, const Options& options);

  Cluster& both() { return both_; }
  const Cluster& both() const { return both_; }
  bool together() const { return together_; }
  void set_together(bool together) { together_ = together; }

  // Before a frame toward these targets (of all god objects): are the hands to be one cluster in it? If that is another
  // answer than before, the state goes over. Hands that are inside each other, as only a start can have them, pass
  // through until they are clear. Returns whether it changed.
  bool decide(std::span<Cluster> hands, PoseSpan targets);

 private:
  bool near(PoseSpan poses, PoseSpan targets);

  Cluster both_;
  std::size_t first_hand_;  // god objects
  double reach_;            // m
  collision::World world_;  // the god objects; those of one hand meet those of the other
  std::vector<Pose<double>> poses_;
  std::vector<collision::Move> moves_;
  bool together_ = false;
};

}  // namespace zwang::god
