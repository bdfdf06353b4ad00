#include <zwang/experiments/god_hand/measure/step_cost.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <zwang/bench/results/statistics.h>
#include <zwang/core/problem/wording.h>

namespace zwang::god {

std::string milliseconds(double seconds) { return printed("%.3g ms", 1e3 * seconds); }
std::string percent(double share) { return std::to_string(std::lround(100 * share)) + " %"; }

StepCost::StepCost(std::size_t last) : last_(last) { totals_.reserve(last); }

void StepCost::add(const StageTimes& times) {
  if (totals_.size() < last_) {
    totals_.push_back(times.total());
  } else {
    totals_[next_] = times.total();
    next_ = (next_ + 1) % last_;
  }
  const auto of_step = stages(times);
  for (std::size_t k = 0; k < stages_.size(); ++k) stages_[k] += of_step[k];
}

double StepCost::quantile(double share) const { return totals_.empty() ? 0 : zwang::quantile(totals_, share); }

double StepCost::seconds() const { return std::accumulate(stages_.begin(), stages_.end(), 0.0); }

std::array<double, stage_names.size()> StepCost::shares() const {
  std::array<double, stage_names.size()> shares = stages_;
  for (double& share : shares) share /= std::max(seconds(), 1e-300);
  return shares;
}

std::string StepCost::line() const {
  const auto share = shares();
  std::vector<std::size_t> order = numbers_from(std::size_t{0}, share.size());
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return share[a] > share[b]; });
  std::vector<std::string> parts;
  for (const std::size_t k : order)
    if (share[k] > 0) parts.push_back(stage_names[k] + (" " + percent(share[k])));
  return "median " + milliseconds(quantile(0.5)) + " a step" + (parts.empty() ? "" : " (" + joined(parts) + ")") +
         ", 99th percentile " + milliseconds(quantile(0.99)) + ", worst " + milliseconds(quantile(1));
}

}  // namespace zwang::god
