#pragma once

#include <string>
#include <vector>

#include <zwang/bench/results/records.h>
#include <zwang/bench/timing/batch.h>

namespace zwang {

// Problems of successive frames, of one mechanism.
struct Sequence {
  static constexpr std::size_t check_every = 20;  // frames
  std::string name = {};
  std::vector<Instance> frames = {};
};

// A hand that presses on a wall while its target wanders 10 mm and 0.1 rad along smooth curves: each frame's problem is
// assembled where the last solution, by dual_active_set, has moved the bodies. Limits come and go.
Sequence hand_sequence(int contacts, int frames);

// Every frame is solved by every solver, cold and from that solver's own solution of the frame before, one after the
// other, so that a slow second of the machine hits all alike. Every 20th frame is checked. A solver that has used up
// its share of `budget` [s] stops early. `runs`: one tolerance each. `time_limit` [s]: of a solve. Empty when
// interrupted.
std::vector<SequenceTimes> time_sequence(const Sequence& sequence, std::span<const Run> runs, double budget,
                                         double time_limit, Dispatcher& desk, const std::atomic<bool>& interrupted);

}  // namespace zwang
