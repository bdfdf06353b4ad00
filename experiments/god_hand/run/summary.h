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
  void add(const Frame& frame);
  // What the last firm hold of the run withstands (measure/disturbance.h) [N], and in which frame that was.
  void set_disturbance(double force, long frame) { disturbance_ = force, disturbance_at_ = frame; }
  // What an audit (audit.h) of all frames came to.
  struct Audited {
    long looked = 0, found = 0, crossed = 0;  // bodies; of these: in an object, in another hand
    long first = -1;                          // frame in which one was found
  };
  void set_audit(const Audited& audited) { audited_ = audited; }

  long frames() const { return columns_.frames(); }
  const StepCost& cost() const { return cost_; }
  // For people, most important first. `record` says what is known of the motion.
  std::vector<std::string> lines(const Record& record) const;
  std::string json(const Record& record) const;

 private:
  double most(std::string_view key) const { return columns_.of(key).most; }
  long count(std::string_view key) const { return static_cast<long>(columns_.of(key).sum); }

  Totals columns_ = {};
  StepCost cost_ = {};
  std::array<long, origin_names.size()> origins_ = {};
  double disturbance_ = 0;
  long disturbance_at_ = -1;
  Audited audited_ = {};
  std::vector<double> raw_ = {}, kept_ = {};  // of the frames with contacts
  std::map<std::string, long> claimed_ = {}, verified_ = {}, faults_ = {};
};

// What is wrong with a frame, or "": penetration, an open joint, a limit crossed, an answer that is not right, NaN.
std::string fault(const Frame& frame);

}  // namespace zwang::god
