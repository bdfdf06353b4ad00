#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include <zwang/experiments/god_hand/run/run_record.h>

namespace zwang::god {

// What a run comes to, from its frames alone. Lengths in m, times in s.
class Summary {
 public:
  explicit Summary(double dt) : dt_(dt) {}
  void add(const Frame& frame);
  // What an audit (audit.h) of all frames came to.
  void set_audit(long looked, long found, long first, long crossed);

  long frames() const { return static_cast<long>(totals_.size()); }
  // For people, most important first. `record` says what is known of the motion.
  std::vector<std::string> lines(const Record& record) const;
  std::string json(const Record& record) const;

 private:
  double dt_;
  std::vector<double> totals_ = {};    // s, a step
  std::array<double, 6> stages_ = {};  // s, of all frames
  double gap_ = 1, depth_ = 0, separation_ = 0, limit_ = 0, distance_ = 0, lost_slide_ = 0, work_ = 0, impulse_ = 0,
         jitter_ = 0, speed_ = 0;
  long touching_ = 0, held_ = 0, stuck_ = 0, behind_ = 0, untracked_ = 0, returned_ = 0, broken_ = 0;
  long audited_ = 0, overlaps_ = 0, first_overlap_ = -1, crossed_ = 0;
  std::vector<int> raw_ = {}, kept_ = {};  // of the frames with contacts
  std::map<std::string, long> claimed_ = {}, verified_ = {};
};

inline constexpr std::array<const char*, 6> stage_names = {"physics", "resolution", "assembly",
                                                           "solve",   "collision",  "other"};
std::array<double, 6> stages(const StageTimes& times);  // in that order

// What is wrong with a frame, or "": penetration, an open joint, a limit crossed, an answer that is not right, NaN.
std::string fault(const Frame& frame);

}  // namespace zwang::god
