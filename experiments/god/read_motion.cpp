#include "collision/mesh_file.h"
#include "experiments/god/motions.h"
#include "experiments/god/retarget.h"

namespace zwang::god {
namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
  for (char& ch : text)
    if (ch >= 'A' && ch <= 'Z') ch = static_cast<char>(ch - 'A' + 'a');
  return text;
}

}  // namespace

Motion read_motion(const fs::path& file) {
  const auto refuse = [&](const std::string& why) { throw BadFile(file.string() + ": " + why); };
  fs::path name = file;
  const collision::StoredFile stored = collision::read_stored(file);
  const bool packed = lower(name.extension().string()) == ".gz";
  const std::string text = packed ? collision::inflated(file, stored.bytes) : stored.bytes;
  if (packed) name = name.stem();
  const std::string kind = lower(name.extension().string());
  if (kind == ".lz")
    refuse("packed by LZString, which is not read here: LZString.decompressFromBase64 of its text is the JSON to give");
  if (kind != ".json") refuse("motions are .json (Leap recordings) or .csv (joint angles), also with .gz");

  Recording recording = parse_leap(file, text);
  Motion motion{.name = name.stem().string()};
  motion.notes = std::move(recording.notes);
  for (const RecordedTrack& track : recording.hands) {
    motion.hands.push_back(retarget(track, fit_model(track)));
    motion.duration = std::max(motion.duration, track.frames.back().time);
  }
  return motion;
}

}  // namespace zwang::god
