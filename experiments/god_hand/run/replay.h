#pragma once

#include <filesystem>
#include <span>

#include <zwang/experiments/god_hand/run/run_record.h>
#include <zwang/experiments/god_hand/run/summary.h>

namespace zwang::god {

// The frames of a run that its page shows: all, or of `most_frames_shown` stretches of equal length the most telling
// ones: a wrong one before a stuck, a held, an untracked one and the first.
class ShownFrames {
 public:
  explicit ShownFrames(long total) : total_(total) {}
  void add(const Frame& frame);  // in order
  const std::vector<Frame>& frames() const { return frames_; }

 private:
  long total_, added_ = 0, place_ = -1;
  std::vector<Frame> frames_ = {};
};

// What the page shows of the god objects of a cluster.
struct ShownGod {
  std::string name;  // "hand", or a tool's
  bool left;         // of a hand
  std::vector<collision::Shape> shapes;
};

// DIR/replay.html: these frames in 3D, one file that needs no network (docs/god-hand.md).
// Throws BadFile when there is no frame or the page cannot be written.
std::filesystem::path write_replay(const std::filesystem::path& directory, const Record& record, const Summary& summary,
                                   const std::vector<Frame>& frames, const Surroundings& surroundings,
                                   std::span<const ShownGod> gods);

inline constexpr long most_frames_shown = 3000;
inline constexpr std::size_t most_triangles_shown = 100000;

}  // namespace zwang::god
