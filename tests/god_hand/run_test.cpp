#include <zwang/experiments/god_hand/run/run.h>

#include <gtest/gtest.h>
#include <unistd.h>
#include <array>
#include <fstream>
#include <sstream>

#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/god_hand/run/frame_store.h>

namespace zwang::god {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("zwang-run-" + std::to_string(getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

Frame frame_of(long number) {
  const double x = static_cast<double>(number) / 3;
  Frame f;
  f.number = number;
  f.time = x;
  f.gap = -x;
  f.device << x, 2 * x, 3 * x, 4 * x, 5 * x, 6 * x;
  f.target = f.god = {retract(Pose<double>{}, Vec<double, 6>(x, 0, 0, x, 1, 0)), {}};
  f.loose = {{{x, x, x}, Mat3::Identity()}};
  f.contacts = {{1, 0, {x, 0, 1}, Vec3::UnitZ(), 2e-4, 0.5}};
  f.rows = 70;
  f.held = number % 2 == 1;
  f.claimed = Status::infeasible;
  f.verified = Verdict::infeasible_proven;
  f.times.solve = x;
  return f;
}

std::vector<Frame> frames_in(const fs::path& directory) {
  std::vector<Frame> frames;
  read_frames(directory, [&](const Frame& f) { frames.push_back(f); });
  return frames;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// frames.jsonl without what was measured with a clock.
std::string untimed(const fs::path& directory) {
  std::istringstream lines(bytes_of(directory / "frames.jsonl"));
  std::string all;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t from = line.find("\"times\":["), to = line.find(']', from);
    all += line.substr(0, from) + line.substr(to) + "\n";
  }
  return all;
}

TEST(FrameStore, GivesBackWhatItWasGiven) {
  const Folder folder;
  {
    FrameWriter writer(folder.path, 2, 1);
    for (long k = 0; k < 5; ++k) writer.write(frame_of(k));
  }
  const std::vector<Frame> frames = frames_in(folder.path);
  ASSERT_EQ(frames.size(), 5u);
  for (long k = 0; k < 5; ++k) {
    const Frame &f = frames[static_cast<std::size_t>(k)], g = frame_of(k);
    EXPECT_EQ(f.number, k);
    for (const Column& column : columns()) EXPECT_EQ(column.of(f), column.of(g)) << column.key;
    EXPECT_EQ(f.device, g.device);
    EXPECT_EQ(f.claimed, g.claimed);
    EXPECT_EQ(f.verified, g.verified);
    EXPECT_EQ(f.times.solve, g.times.solve);
    EXPECT_EQ(f.god[0].position, g.god[0].position);
    EXPECT_LE((f.god[0].rotation - g.god[0].rotation).norm(), 1e-15);
    EXPECT_EQ(f.loose[0].position, g.loose[0].position);
    ASSERT_EQ(f.contacts.size(), 1u);
    EXPECT_FLOAT_EQ(static_cast<float>(f.contacts[0].point.x()), static_cast<float>(g.contacts[0].point.x()));
  }
}

TEST(FrameStore, ATornEndDoesNotCountAndIsWrittenOver) {
  const Folder folder;
  {
    FrameWriter writer(folder.path, 2, 1);
    for (long k = 0; k < 5; ++k) writer.write(frame_of(k));
  }
  std::ofstream(folder.path / "frames.jsonl", std::ios::app) << "{\"n\":5,\"t\":";
  EXPECT_EQ(frames_in(folder.path).size(), 5u);
  fs::resize_file(folder.path / "poses.bin", fs::file_size(folder.path / "poses.bin") - 3);
  EXPECT_EQ(frames_in(folder.path).size(), 4u);
  {
    FrameWriter writer(folder.path, 2, 1, 3);
    writer.write(frame_of(7));
  }
  const std::vector<Frame> frames = frames_in(folder.path);
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_EQ(frames.back().number, 7);
}

TEST(FrameStore, RefusesWhatIsNoFrameAndAFrameOfAnotherRun) {
  const Folder folder;
  FrameWriter writer(folder.path, 2, 1);
  Frame other = frame_of(0);
  other.loose.clear();
  EXPECT_THROW(writer.write(other), std::logic_error);
  for (long k = 0; k < 2; ++k) writer.write(frame_of(k));
  writer.flush();
  const std::string lines = bytes_of(folder.path / "frames.jsonl");
  std::ofstream(folder.path / "frames.jsonl") << "nonsense\n" << lines;
  EXPECT_THROW(frames_in(folder.path), BadFile);
  EXPECT_THROW(FrameWriter(folder.path, 2, 1, 9), BadFile);
}

TEST(Run, ResumedEqualsUninterruptedBitByBit) {
  const Folder folder;
  Record record;
  record.asked = {.scene = "box", .motion = "slide", .frames = checkpoint_every + 320};
  record.asked.options.verify = false;
  const Stage stage = set_up(record);
  const std::atomic<bool> never = false;
  for (const char* name : {"whole", "stopped"}) fs::create_directories(folder.path / name);
  EXPECT_EQ(simulate(
                folder.path / "whole", record, stage, false, [](double, const std::string&) {}, never),
            record.asked.frames);

  // Stopped well after the checkpoint: those frames are done again.
  std::atomic<bool> now = false;
  long seen = 0;
  const long stopped = simulate(
      folder.path / "stopped", record, stage, false,
      [&](double, const std::string&) { now = ++seen == checkpoint_every + 200; }, now);
  EXPECT_EQ(stopped, checkpoint_every + 200);
  EXPECT_EQ(simulate(
                folder.path / "stopped", record, stage, true, [](double, const std::string&) {}, never),
            record.asked.frames);
  EXPECT_EQ(bytes_of(folder.path / "whole" / "poses.bin"), bytes_of(folder.path / "stopped" / "poses.bin"));
  EXPECT_EQ(untimed(folder.path / "whole"), untimed(folder.path / "stopped"));

  record.asked.audit = true;
  const Finished finished = finish(folder.path / "whole", record, stage, [](double, const std::string&) {});
  EXPECT_TRUE(fs::exists(finished.replay));
  EXPECT_NE(bytes_of(folder.path / "whole" / "summary.json").find("\"overlaps\": 0"), std::string::npos);
}

TEST(Run, RecordComesBack) {
  const Folder folder;
  Record record;
  record.asked = {.scene = "wall", .motion = "press", .share = 0.5, .frames = 12, .audit = true};
  record.asked.options.commit = Options::Commit::printed;
  record.asked.options.force_cap = 12;
  record.motion = 0xfedcba9876543210;
  record.notes = {"one"};
  write_record(folder.path, record);
  const Record back = read_record(folder.path);
  EXPECT_EQ(back.asked.scene, "wall");
  EXPECT_EQ(back.asked.frames, 12);
  EXPECT_TRUE(back.asked.audit);
  EXPECT_EQ(back.asked.options.commit, Options::Commit::printed);
  EXPECT_EQ(back.asked.options.force_cap, 12);
  EXPECT_EQ(back.motion, record.motion);
  EXPECT_EQ(back.notes, record.notes);
  EXPECT_NO_THROW(require_same_program(folder.path));
  std::ofstream(folder.path / "run.json") << "{";
  EXPECT_THROW(read_record(folder.path), BadFile);
}

}  // namespace
}  // namespace zwang::god
