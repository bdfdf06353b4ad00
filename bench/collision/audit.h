#pragma once

#include <memory>
#include <variant>
#include <vector>

#include <zwang/bench/collision/witness.h>

namespace zwang {

// What a hand meets.
using Obstacle = std::variant<collision::Shape, std::shared_ptr<const collision::Tree>>;

// FCL as an independent witness of poses: does any body of a hand overlap an obstacle? Two hands do not meet each
// other; where they cross is counted apart.
class Audit {
 public:
  // `hands`: the shapes of each hand's bodies.
  Audit(std::vector<std::vector<collision::Shape>> hands, std::vector<Obstacle> obstacles);

  // `bodies`: poses of all bodies, hand after hand; `obstacles`: one for each. Returns how many bodies overlap one.
  long check(PoseSpan bodies, PoseSpan obstacles);

  long checked() const { return checked_; }  // bodies, over all calls
  long found() const { return found_; }      // of these: that overlapped an obstacle
  long crossed() const { return crossed_; }  // of these: that overlapped an earlier hand

 private:
  bool overlaps(const collision::Shape& shape, const Pose<double>& pose, PoseSpan obstacles) const;
  bool crosses(std::size_t hand, const collision::Shape& shape, const Pose<double>& pose, PoseSpan bodies) const;

  std::vector<std::vector<collision::Shape>> hands_;
  std::vector<Obstacle> obstacles_;
  Witness witness_;
  long checked_ = 0, found_ = 0, crossed_ = 0;
};

}  // namespace zwang
