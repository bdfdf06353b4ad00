#include <zwang/experiments/god_hand/run/summary.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <zwang/bench/results/statistics.h>
#include <zwang/core/problem/wording.h>

namespace zwang::god {
namespace {

std::string length(double metres) {
  if (metres == 0) return "0";
  if (std::abs(metres) >= 1e-5) return printed("%.3g mm", 1e3 * metres);
  return printed("%.1e m", metres);
}
std::string rate(double seconds) { return seconds > 0 ? grouped(std::lround(1 / seconds)) + " Hz" : "any rate"; }

// "1,204 solved, 3 near"
std::string tally(const std::map<std::string, long>& counts) {
  return joined(names_of(counts, [](const auto& count) { return grouped(count.second) + " " + count.first; }));
}

bool finite(const Frame& frame) {
  const auto is_finite = [](const Pose<double>& p) { return p.position.allFinite() && p.rotation.allFinite(); };
  return std::ranges::all_of(frame.god, is_finite) && std::ranges::all_of(frame.loose, is_finite);
}

}  // namespace

std::string fault(const Frame& frame) {
  if (!finite(frame)) return "NaN";
  if (frame.gap < 0) return "penetration";
  if (frame.separation > closed_within) return "open joint";
  if (frame.limit > closed_within) return "limit crossed";
  if (frame.verified == Verdict::wrong) return "wrong answer";
  return "";
}

void Summary::add(const Frame& f) {
  cost_.add(f.times);
  columns_.add(f);
  if (const std::string what = fault(f); !what.empty()) ++faults_[what];
  ++origins_[static_cast<std::size_t>(f.origin)];
  if (f.raw > 0) {
    raw_.push_back(f.raw);
    kept_.push_back(f.kept);
  }
  if (f.claimed != Status::unsolved) {
    ++claimed_[std::string(to_string(f.claimed))];
    if (f.verified) ++verified_[std::string(to_string(*f.verified))];
  }
}

std::vector<std::string> Summary::lines(const Record& record) const {
  if (frames() == 0) return {"No frame was simulated."};
  const auto n = static_cast<double>(frames());
  const double dt = record.asked.options.dt;  // s
  // The verdict, in one line.
  std::vector<std::string> out = {faults_.empty()
                                      ? "Nothing penetrated, joints and limits held"
                                      : "Faults (\"next wrong\" in the replay shows them): " + tally(faults_)};
  out[0] += (count("stuck") == 0 ? ", nothing stuck" : ", stuck in " + counted(count("stuck"), "frame")) + "; " +
            milliseconds(cost_.quantile(0.5)) + " a step: " + rate(cost_.quantile(0.5)) + " in the median, " +
            rate(cost_.quantile(0.99)) + " at the 99th percentile";
  out.push_back(
      counted(frames(), "frame") + " of " + milliseconds(dt) + " simulated at " + grouped(std::lround(1 / dt)) +
      " Hz: deepest penetration " + length(std::max(0.0, -columns_.of("gap").least)) + ", joints " +
      length(most("joint")) + ", " +
      (most("limit") <= closed_within ? "limits kept" : "limits crossed by " + printed("%.2g rad", most("limit"))) +
      ", held " + std::to_string(count("held")));
  out.push_back(cost_.line() + (raw_.empty() ? ""
                                             : ", contacts " + printed("%.0f", median(raw_)) + " -> " +
                                                   printed("%.0f", median(kept_)) + " (medians)"));
  out.push_back("The hand touches in " + percent(static_cast<double>(columns_.touching()) / n) +
                " of the frames; its target is at most " + length(most("depth")) + " inside an object and " +
                length(most("dist")) + " from the hand" +
                (count("behind") > 0 ? "; the target was beyond a thin part in " + counted(count("behind"), "frame") +
                                           ", the hand before it"
                                     : ""));
  if (most("grip") > 0)
    out.push_back("Loose objects are held with up to " + printed("%.3g N", most("grip")) + " (mu " +
                  printed("%.3g", record.asked.options.mu) + "); once the target rests, contacts creep by " +
                  printed("%.2g um/s", 1e6 * most("creep")) + " at most; momentum balanced to " +
                  printed("%.1e", most("impulse")) + "; let go within " + milliseconds(most("late")) +
                  (disturbance_at_ < 0 ? ""
                                       : "; in frame " + std::to_string(disturbance_at_) + " the hold withstands " +
                                             printed("%.3g N", disturbance_) + " in the worst direction"));
  std::string origins;
  for (std::size_t k = 0; k < origins_.size(); ++k)
    if (origins_[k] > 0) origins += (origins.empty() ? "" : ", ") + grouped(origins_[k]) + " " + origin_names[k];
  out.push_back("Where the frames came from: " + origins);
  if (record.recorded)
    out.push_back("Recording retargeted to within " + length(record.misfit_mean) + " on average, " +
                  length(record.misfit_most) + " at most; " + counted(record.held_over, "recorded frame") +
                  " without a hand held over");
  out.insert(out.end(), record.notes.begin(), record.notes.end());
  if (const long untracked = frames() - count("tracked"); untracked > 0)
    out.push_back(counted(untracked, "frame") + " without tracking: the last target was kept");
  if (const long returned = count("returned"); returned > 0)
    out.push_back(counted(returned, "object") + " put back clear of the hand");
  if (!claimed_.empty())
    out.push_back("Solves claimed: " + tally(claimed_) + "; the referee " +
                  (verified_.empty()
                       ? "looked at none"
                       : "on one frame in " + std::to_string(record.asked.options.verify) + ": " + tally(verified_)) +
                  " (by frame, the worst)");
  if (audited_.looked > 0)
    out.push_back(
        "Penetrations found by FCL: " + grouped(audited_.found) + " of " + counted(audited_.looked, "body-frame") +
        (audited_.found > 0 ? ", the first in frame " + std::to_string(audited_.first) : "") +
        (audited_.crossed > 0 ? "; the hands cross each other in " + counted(audited_.crossed, "body-frame") : ""));
  return out;
}

std::string Summary::json(const Record& record) const {
  using Json = nlohmann::ordered_json;
  Json shares, origins;
  for (std::size_t k = 0; k < stage_names.size(); ++k) shares[stage_names[k]] = cost_.shares()[k];
  long faulty = 0;
  for (const auto& [what, n] : faults_) faulty += n;
  for (std::size_t k = 0; k < origins_.size(); ++k) origins[origin_names[k]] = origins_[k];
  const Json j = {
      {"scene", record.asked.scene},
      {"motion", record.title},
      {"solver", record.asked.options.solver},
      {"rate_hz", 1 / record.asked.options.dt},
      {"frames", frames()},
      {"finished", !record.finished.empty()},
      {"penetration_m", std::max(0.0, -columns_.of("gap").least)},
      {"smallest_gap_m", columns_.of("gap").least},
      {"joint_separation_m", most("joint")},
      {"limit_violation_rad", most("limit")},
      {"stuck_frames", count("stuck")},
      {"held_frames", count("held")},
      {"origins", origins},
      {"faulty_frames", faulty},
      {"target_beyond_thin_part_frames", count("behind")},
      {"untracked_frames", frames() - count("tracked")},
      {"objects_put_back", count("returned")},
      {"touching_share", frames() > 0 ? static_cast<double>(columns_.touching()) / static_cast<double>(frames()) : 0},
      {"target_depth_m", most("depth")},
      {"target_distance_m", most("dist")},
      {"lost_slide_m", columns_.of("slide").sum},
      {"jitter_m", most("jitter")},
      {"work_j", columns_.of("work").sum},
      {"impulse_error", most("impulse")},
      {"object_speed_m_s", most("speed")},
      {"mu", record.asked.options.mu},
      {"grip_n", most("grip")},
      {"friction_used", most("friction")},
      {"slip_m_s", most("slip")},
      {"creep_um_s", 1e6 * most("creep")},
      {"release_latency_s", most("late")},
      {"disturbance_held_n", disturbance_at_ < 0 ? Json(nullptr) : Json(disturbance_)},
      {"disturbance_frame", disturbance_at_ < 0 ? Json(nullptr) : Json(disturbance_at_)},
      {"step_s",
       {{"median", cost_.quantile(0.5)},
        {"p99", cost_.quantile(0.99)},
        {"worst", cost_.quantile(1)},
        {"median_hz", cost_.quantile(0.5) > 0 ? 1 / cost_.quantile(0.5) : 0},
        {"shares", shares}}},
      {"contacts",
       {{"raw_median", raw_.empty() ? 0 : median(raw_)}, {"kept_median", raw_.empty() ? 0 : median(kept_)}}},
      {"claimed", claimed_},
      {"verified", verified_},
      {"audit",
       audited_.looked > 0
           ? Json{{"body_frames", audited_.looked}, {"overlaps", audited_.found}, {"hands_crossed", audited_.crossed}}
           : Json(nullptr)},
      {"misfit_m", {{"mean", record.misfit_mean}, {"most", record.misfit_most}}},
      {"recorded_frames_held_over", record.held_over},
      {"placement", {{"inside_share", record.placement.inside}, {"depth_m", record.placement.depth}}}};
  return j.dump(2) + "\n";
}

}  // namespace zwang::god
