#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include <zwang/experiments/god_hand/measure/step_cost.h>
#include <zwang/experiments/god_hand/run/run_record.h>

namespace zwang::god {

// What a run comes to, from its frames alone. Lengths in m, times in s.
class Summary {
 public:
  explicit Summary(double dt) : dt_(dt) {}
  void add(const Frame& frame);
  // What the last firm hold of the run withstands (measure/disturbance.h) [N], and in which frame that was.
  void set_disturbance(double force, long frame) { disturbance_ = force, disturbance_at_ = frame; }
  // What an audit (audit.h) of all frames came to.
  void set_audit(long looked, long found, long first, long crossed);

  long frames() const { return columns_.frames(); }
  const StepCost& cost() const { return cost_; }
  // For people, most important first. `record` says what is known of the motion.
  std::vector<std::string> lines(const Record& record) const;
  std::string json(const Record& record) const;

 private:
  double most(std::string_view key) const { return columns_.most(key); }
  long count(std::string_view key) const { return static_cast<long>(columns_.sum(key)); }

  double dt_;
  Totals columns_ = {};
  StepCost cost_ = {};
  std::array<long, origin_names.size()> origins_ = {};
  double disturbance_ = 0;
  long disturbance_at_ = -1;
  long audited_ = 0, overlaps_ = 0, first_overlap_ = -1, crossed_ = 0;
  std::vector<double> raw_ = {}, kept_ = {};  // of the frames with contacts
  std::map<std::string, long> claimed_ = {}, verified_ = {}, faults_ = {};
};

// What is wrong with a frame, or "": penetration, an open joint, a limit crossed, an answer that is not right, NaN.
std::string fault(const Frame& frame);

}  // namespace zwang::god
