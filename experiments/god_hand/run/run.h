#pragma once

#include <atomic>
#include <filesystem>
#include <functional>

#include <zwang/experiments/god_hand/run/run_record.h>
#include <zwang/experiments/god_hand/run/summary.h>
#include <zwang/experiments/god_hand/tools/tool.h>

namespace zwang::god {

// What a run works on, made from what was asked for.
struct Setup {
  Surroundings surroundings = {};
  HandMotion motion = {};
  std::optional<Tool> tool = {};  // none: hands
};

// Scene, god objects and motion; a recording is placed where it works. Fills what `record` says of them, and
// asked.frames where it is 0. Throws as make_surroundings, read_motion and synthetic_motion do, and
// std::invalid_argument for a solver there is not.
Setup set_up(Record& record);

// Fraction done, what is going on.
using ShowProgress = std::function<void(double, const std::string&)>;

// Simulates the frames that are still to do into the folder, from the last checkpoint where `resume`, and returns how
// many there are then. `interrupted` ends it after a frame.
long simulate(const std::filesystem::path& directory, const Record& record, const Setup& setup, bool resume,
              const ShowProgress& progress, const std::atomic<bool>& interrupted);

// From the frames in the folder: summary.json and replay.html; where asked.audit, FCL looks at every frame.
struct Finished {
  Summary summary = {};
  std::filesystem::path replay = {};
};
Finished finish(const std::filesystem::path& directory, const Record& record, const Setup& setup,
                const ShowProgress& progress);

}  // namespace zwang::god
