#include <algorithm>

#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/experiments/god_hand/motion/joint_table.h>
#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/motion/retarget.h>

namespace zwang::god {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest = 256 << 20;  // bytes of text, unpacked: hours of a recording

// Between the keys of a recording, the median [s].
double usual_pause(const Track& track) {
  std::vector<double> pauses;
  for (std::size_t k = 1; k < track.keys.size(); ++k) pauses.push_back(track.keys[k].time - track.keys[k - 1].time);
  return upper_median(pauses);
}

}  // namespace

HandMotion read_motion(const fs::path& file) {
  const auto refuse = [&](const std::string& why) { throw BadFile(file.string() + ": " + why); };
  const StoredFile stored = read_stored(file);
  const std::string kind = stored.kind(), text = unpacked(stored, longest);
  if (kind == ".lz")
    refuse("packed by LZString, which is not read here: LZString.decompressFromBase64 of its text is the JSON to give");
  if (kind != ".json" && kind != ".csv")
    refuse("motions are .json (Leap recordings) or .csv (joint angles), also with .gz");

  Recording recording;
  HandMotion motion;
  if (kind == ".json") {
    recording = parse_leap(file, text);
  } else {
    const JointTable table = parse_table(file, text);
    if (is_adroit(table))
      recording = adroit_recording(table);
    else
      motion = plain_motion(table);
  }
  motion.name = (stored.packed() ? file.stem() : file).stem().string();
  motion.notes.insert(motion.notes.end(), recording.notes.begin(), recording.notes.end());
  for (const RecordedTrack& track : recording.hands) {
    motion.hands.push_back(retarget(track));
    motion.duration = std::max(motion.duration, track.frames.back().time);
  }
  if (std::ranges::any_of(motion.hands, [](const Track& track) { return track.keys.empty(); }))
    refuse("no frame has a hand that could be tracked: finite numbers within a kilometre expected");
  for (Track& track : motion.hands) track.patience = std::max(track.patience, 2.5 * usual_pause(track));
  for (const Track& track : motion.hands)
    note(motion.notes, track.held_over,
         std::string("without the ") + (track.model.left ? "left" : "right") + " hand: its last pose held over");
  return motion;
}

}  // namespace zwang::god
