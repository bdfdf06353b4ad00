#include <zwang/experiments/god_hand/step/meeting.h>

#include <algorithm>

namespace zwang::god {

Meeting::Meeting(GodObjects both, std::size_t first_hand, const Surroundings& surroundings, const Options& options)
    : both_(std::move(both), surroundings, options),
      first_hand_(first_hand),
      // What both may move beyond the way to their targets.
      reach_(options.activation + 2 * options.sub_steps * std::max(options.catch_up * options.dt, options.activation)) {
  const GodObjects& objects = both_.objects();
  for (std::size_t b = 0; b < objects.shapes.size(); ++b) {
    const std::uint64_t mine = b < first_hand_ ? 1 : 2;
    world_.add(objects.shapes[b], objects.scene.bodies[b].pose, {mine, 3 - mine});
  }
}

bool Meeting::near(PoseSpan poses, PoseSpan targets) {
  moves_.clear();
  for (std::size_t b = 0; b < poses.size(); ++b) {
    world_.place(static_cast<int>(b), poses[b]);
    moves_.push_back({static_cast<int>(b), twist_between(poses[b], targets[b])});
  }
  return !world_.touches(reach_).empty() || world_.time_of_contact(moves_).time < 1;
}

bool Meeting::decide(std::span<Cluster> hands, PoseSpan targets) {
  poses_.clear();
  if (together_)
    poses_.assign(both_.poses().begin(), both_.poses().end());
  else
    for (const Cluster& hand : hands) poses_.insert(poses_.end(), hand.poses().begin(), hand.poses().end());
  bool together = near(poses_, targets);
  if (together && !together_)
    for (const collision::Touch& touch : world_.touches(reach_)) together = together && touch.gap > 0;
  if (together == together_) return false;
  together_ = together;
  if (together) {
    Cluster::Memory all = hands[0].memory();
    const Cluster::Memory second = hands[1].memory();
    const auto append = [](auto& to, const auto& more) { to.insert(to.end(), more.begin(), more.end()); };
    append(all.pose, second.pose), append(all.target, second.target), append(all.last_step, second.last_step);
    append(all.met_at, second.met_at);
    all.next = std::max(all.next, second.next);
    all.step_scale = std::min(all.step_scale, second.step_scale);
    both_.restore(all);
    return true;
  }
  const Cluster::Memory all = both_.memory();
  for (std::size_t h = 0; h < 2; ++h) {
    Cluster::Memory one = all;
    const auto part = [&](auto& list) {
      if (list.empty()) return;
      const auto middle = list.begin() + static_cast<long>(first_hand_);
      h == 0 ? list.erase(middle, list.end()) : list.erase(list.begin(), middle);
    };
    part(one.pose), part(one.target), part(one.last_step), part(one.met_at);
    hands[h].restore(one);
  }
  return true;
}

}  // namespace zwang::god
