#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace zwang {

struct CollisionSuiteOptions {
  std::filesystem::path directory = {};  // collision.json goes there
  std::filesystem::path data = {};       // real parts; procedural ones stand in where it is absent
  std::filesystem::path cache = {};      // of trees; empty: none
  std::string command = {};
  bool terminal = false;  // draw a progress bar
};

// The collision suite: pair queries (zwang, a conservative advancement over fcl::distance, Bullet's convexSweepTest) by
// triangle count and gap; the 16-body hand dragged over parts, once for time and once under audit. Results as
// collision.json after every study. Returns what a reader wants first, a line each; false in `done` when interrupted.
std::vector<std::string> run_collision_suite(const CollisionSuiteOptions& options, const std::atomic<bool>& interrupted,
                                             bool& done);

}  // namespace zwang
