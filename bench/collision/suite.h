#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include <zwang/bench/collision/moving_hand.h>

namespace zwang {

struct CollisionSuiteOptions {
  std::filesystem::path directory = {};  // collision.json goes there
  std::vector<HandScene> hands = {};     // of the program; none: pairs alone
  std::string command = {};
  bool terminal = false;  // draw a progress bar
};

// The collision suite: pair queries (zwang, a conservative advancement over fcl::distance, Bullet's convexSweepTest) by
// triangle count and gap; every run of the hands, once for time, once under audit, and
// with friction, twice as long, under audit. Results as collision.json after
// every study. Returns what a reader wants first, a line each; false in `done` when interrupted.
std::vector<std::string> run_collision_suite(const CollisionSuiteOptions& options, const std::atomic<bool>& interrupted,
                                             bool& done);

}  // namespace zwang
