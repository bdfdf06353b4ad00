#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <string>

#include <zwang/experiments/god_hand/step/frame.h>

namespace zwang::god {

// The frames of a run in its folder (docs/god-hand.md lists the columns):
//
//   frames.jsonl  one line a frame, appended: every number of frame.h but the poses
//   poses.bin     the poses of the same frames in double precision, records of one size
//   checkpoint    the state of the simulation after a multiple of `checkpoint_every` frames

inline constexpr long checkpoint_every = 500;  // a resumed run repeats fewer frames than this

// A number of a frame under the name it has in frames.jsonl: one of the three members.
struct Column {
  const char* key;
  double Frame::* number = nullptr;
  int Frame::* count = nullptr;
  bool Frame::* flag = nullptr;

  double of(const Frame& frame) const {
    return number ? frame.*number : count ? frame.*count : static_cast<double>(frame.*flag);
  }
};
std::span<const Column> columns();

class FrameWriter {
 public:
  // `keep`: so many of the frames that are in the folder already stay, the others go. bodies: god objects of all hands.
  FrameWriter(const std::filesystem::path& directory, std::size_t bodies, std::size_t loose, long keep = 0);
  // Throws std::logic_error when the frame has other numbers of poses.
  void write(const Frame& frame);
  void flush();  // throws BadFile when the disk is full

 private:
  std::filesystem::path directory_;
  std::size_t bodies_, loose_;
  std::ofstream lines_, poses_;
  std::string line_;
};

// Visits every whole frame in order and returns their number. What a killed run left torn at the end does not count;
// anything else that is broken throws BadFile.
long read_frames(const std::filesystem::path& directory, const std::function<void(const Frame&)>& visit);

struct Checkpoint {
  long frames = 0;  // that were done; 0: from the beginning
  std::string state = {};
};
void write_checkpoint(const std::filesystem::path& directory, const Checkpoint& checkpoint);  // in one step
Checkpoint read_checkpoint(const std::filesystem::path& directory);                           // {} where there is none

}  // namespace zwang::god
