#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <zwang/core/files/hdf5.h>
#include <zwang/experiments/god_hand/measure/columns.h>

namespace zwang::god {

// The files of a run that hold frames, both HDF5 (docs/god-hand/files.md lists the datasets):
//
//   frames.h5      a dataset for each quantity, a row for each frame; appended while the run goes on
//   checkpoint.h5  the state of the simulation after a multiple of `checkpoint_every` frames
//
// A run that is killed leaves both readable, frames.h5 with all frames up to the last flush().

inline constexpr long checkpoint_every = 500;  // a resumed run repeats fewer frames than this

// A dataset of frames.h5: a row for each frame, or for each contact, frame after frame.
struct Dataset {
  std::string name = {}, unit = {}, meaning = {};
  hdf5::Group::Stored type = {};
  std::vector<std::size_t> row = {};  // its shape; {}: one number
  bool of_contacts = false;
  std::function<void(const Frame&, std::vector<double>&)> put = {};  // appends a frame's numbers
  std::function<void(Frame&, const double*&)> take = {};             // and takes them back
};

class FrameWriter {
 public:
  // `keep`: so many of the frames that are in the folder already stay, the others go. bodies: god objects of all hands.
  FrameWriter(const std::filesystem::path& directory, std::size_t bodies, std::size_t loose, long keep = 0);
  // Kept in memory until flush(). Throws std::logic_error when the frame has other numbers of poses.
  void write(const Frame& frame);
  void flush();  // throws BadFile when the disk is full

 private:
  std::size_t bodies_, loose_;
  std::vector<Dataset> datasets_;
  std::vector<std::vector<double>> waiting_;  // by dataset: not yet written
  hdf5::Group file_;
};

// The frames of a folder, each read once. What a killed run left torn at the end does not count; anything else that is
// broken throws BadFile.
class FrameReader {
 public:
  explicit FrameReader(const std::filesystem::path& directory);
  long frames() const { return frames_; }
  const hdf5::Group& file() const { return file_; }
  void each(const std::function<void(const Frame&)>& visit) const;  // in order

 private:
  hdf5::Group file_;
  std::size_t bodies_, loose_;
  std::vector<Dataset> datasets_;
  long frames_ = 0;
};

struct Checkpoint {
  long frames = 0;                 // that were done; 0: from the beginning
  std::vector<double> state = {};  // of Simulation
};
void write_checkpoint(const std::filesystem::path& directory, const Checkpoint& checkpoint);  // in one step
Checkpoint read_checkpoint(const std::filesystem::path& directory);                           // {} where there is none

}  // namespace zwang::god
