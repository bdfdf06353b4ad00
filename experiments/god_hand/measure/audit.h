#pragma once

#include <memory>
#include <span>

#include <zwang/experiments/god_hand/scenes/surroundings.h>
#include <zwang/experiments/god_hand/step/frame.h>

namespace zwang::god {

// FCL as an independent witness of committed frames: does any god object overlap an object? Hands are clusters of their
// own that do not meet each other; where two of them cross is counted apart.
class Audit {
 public:
  // `hands`: the shapes of each hand's god objects, in the order of Frame::god. Both must outlive the audit.
  Audit(const Surroundings& surroundings, std::span<const std::vector<collision::Shape>> hands);
  ~Audit();

  void look(const Frame& frame);
  long looked() const { return looked_; }    // god objects times frames
  long found() const { return found_; }      // of these: that overlapped an object
  long crossed() const { return crossed_; }  // of these: that overlapped an earlier hand
  long first() const { return first_; }      // number of the first frame with one in an object, or -1

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
  long looked_ = 0, found_ = 0, crossed_ = 0, first_ = -1;
};

}  // namespace zwang::god
