#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/simulation.h>
#include <zwang/experiments/god_hand/tools/tool.h>

namespace zwang::god {

// What a run was asked for, defaults filled in.
struct Asked {
  std::string scene = "simple", parts = {}, god = "hand", motion = "grasp";  // as typed; files by their absolute paths
  Options options = {};
  double share = 0.45;  // of the frames of a recording in which its target is to be inside an object
  long frames = 0;      // to be simulated
  bool audit = false;
};

// DIR/run.json: what was asked for, under which conditions, and what it takes to go on (docs/god-hand/files.md).
struct Record {
  std::string command = {}, started = {}, finished = {};  // ISO 8601, UTC; finished is "" until the run is complete
  Asked asked = {};
  std::uint64_t motion = 0, surroundings = 0, god = 0;          // fingerprints of what the run began with
  std::string title = {};                                       // of the motion
  std::size_t hands = 0, bodies = 0, loose = 0, held_over = 0;  // bodies: god objects
  std::vector<std::string> notes = {};                          // on the motion, one line each
  bool recorded = false;                    // the motion is a recording: misfit and placement say something
  double misfit_mean = 0, misfit_most = 0;  // m, of the worst hand
  Placement placement = {};
};

void write_record(const std::filesystem::path& directory, const Record& record);  // in one step
Record read_record(const std::filesystem::path& directory);  // throws BadFile where there is none, or it is broken

// Throws std::invalid_argument when this program is not the one that began the run, whose bits could differ.
void require_same_program(const std::filesystem::path& directory);

// 64 bits that are others when a number is another.
std::uint64_t fingerprint(const HandMotion& motion);
std::uint64_t fingerprint(const Surroundings& surroundings);
std::uint64_t fingerprint(const Tool& tool);

}  // namespace zwang::god
