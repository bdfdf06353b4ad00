#include <zwang/experiments/god_hand/run/run.h>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <optional>
#include <random>
#include <sstream>

#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/god_hand/run/frame_store.h>
#include "tests/folders.h"

namespace zwang::god {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = own_path("run");
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

Frame frame_of(long number) {
  const double x = static_cast<double>(number) / 3;
  Frame f;
  f.number = number;
  f.time = x;
  f.gap = -x;
  f.palm_wrench << x, 2 * x, 3 * x, 4 * x, 5 * x, 6 * x;
  f.target = f.god = {retract(Pose<double>{}, Vec<double, 6>(x, 0, 0, x, 1, 0)), {}};
  f.loose = {{{x, x, x}, Mat3::Identity()}};
  for (int k = 0; k < number % 4; ++k) f.contacts.push_back({k, 0, {x, k + 0., 1}, Vec3::UnitZ(), 2e-4, 0.5});
  f.rows = 70;
  f.held = number % 2 == 1;
  f.origin = static_cast<Origin>(number % 6);
  f.claimed = Status::infeasible;
  f.verified = Verdict::infeasible_proven;
  f.times.solve = x;
  return f;
}

std::vector<Frame> frames_in(const fs::path& directory) {
  std::vector<Frame> frames;
  FrameReader(directory).each([&](const Frame& f) { frames.push_back(f); });
  return frames;
}

void write_frames(const fs::path& directory, long count) {
  FrameWriter writer(directory, 2, 1);
  for (long k = 0; k < count; ++k) writer.write(frame_of(k));
  writer.flush();
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

void expect_same(const std::vector<Pose<double>>& a, const std::vector<Pose<double>>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].position, b[k].position);
    EXPECT_EQ(a[k].rotation, b[k].rotation);
  }
}

// To the bit, but for what was measured with a clock.
void expect_same(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.number, b.number);
  for (const Column& column : columns()) EXPECT_EQ(column.of(a), column.of(b)) << column.key;
  EXPECT_EQ(a.palm_wrench, b.palm_wrench);
  EXPECT_EQ(a.claimed, b.claimed);
  EXPECT_EQ(a.verified, b.verified);
  expect_same(a.target, b.target);
  expect_same(a.god, b.god);
  expect_same(a.loose, b.loose);
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  for (std::size_t k = 0; k < a.contacts.size(); ++k) {
    const FrameContact &c = a.contacts[k], &d = b.contacts[k];
    EXPECT_TRUE(c.body == d.body && c.object == d.object && c.gap == d.gap && c.push == d.push);
    EXPECT_EQ(c.point, d.point);
    EXPECT_EQ(c.normal, d.normal);
  }
}

TEST(FrameStore, GivesBackWhatItWasGiven) {
  const Folder folder;
  const long count = checkpoint_every + 3;  // more than are read at once
  write_frames(folder.path, count);
  const std::vector<Frame> frames = frames_in(folder.path);
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(count));
  for (long k = 0; k < count; ++k) {
    const Frame &f = frames[static_cast<std::size_t>(k)], g = frame_of(k);
    EXPECT_EQ(f.number, k);
    for (const Column& column : columns()) EXPECT_EQ(column.of(f), column.of(g)) << column.key;
    EXPECT_EQ(f.palm_wrench, g.palm_wrench);
    EXPECT_EQ(f.claimed, g.claimed);
    EXPECT_EQ(f.verified, g.verified);
    EXPECT_EQ(f.times.solve, g.times.solve);
    EXPECT_EQ(f.god[0].position, g.god[0].position);
    EXPECT_LE((f.god[0].rotation - g.god[0].rotation).norm(), 1e-15);
    EXPECT_EQ(f.loose[0].position, g.loose[0].position);
    ASSERT_EQ(f.contacts.size(), g.contacts.size());
    for (std::size_t c = 0; c < f.contacts.size(); ++c) {
      EXPECT_EQ(f.contacts[c].body, g.contacts[c].body);
      EXPECT_FLOAT_EQ(static_cast<float>(f.contacts[c].point.x()), static_cast<float>(g.contacts[c].point.x()));
    }
  }
}

TEST(FrameStore, ARunWithoutLooseObjectsHasNoneOfTheirPoses) {
  const Folder folder;
  {
    FrameWriter writer(folder.path, 2, 0);
    Frame frame = frame_of(0);
    frame.loose.clear();
    writer.write(frame);
    writer.flush();
  }
  ASSERT_EQ(frames_in(folder.path).size(), 1u);
  EXPECT_TRUE(frames_in(folder.path)[0].loose.empty());
}

// Killed after frames that were not flushed.
TEST(FrameStore, AKilledRunKeepsWhatWasFlushedAndGoesOn) {
  const Folder folder;
  if (const pid_t child = fork(); child == 0) {
    FrameWriter writer(folder.path, 2, 1);
    for (long k = 0; k < 7; ++k) {
      writer.write(frame_of(k));
      if (k == 4) writer.flush();
    }
    kill(getpid(), SIGKILL);
  } else {
    waitpid(child, nullptr, 0);
  }
  EXPECT_EQ(frames_in(folder.path).size(), 5u);
  {
    FrameWriter writer(folder.path, 2, 1, 3);
    writer.write(frame_of(7));
    writer.flush();
  }
  const std::vector<Frame> frames = frames_in(folder.path);
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_EQ(frames[2].number, 2);
  EXPECT_EQ(frames.back().number, 7);
  EXPECT_EQ(frames.back().contacts.size(), frame_of(7).contacts.size());
}

TEST(FrameStore, RefusesWhatIsNoFrameAndAFrameOfAnotherRun) {
  const Folder folder;
  {
    FrameWriter writer(folder.path, 2, 1);
    Frame other = frame_of(0);
    other.loose.clear();
    EXPECT_THROW(writer.write(other), std::logic_error);
    for (long k = 0; k < 2; ++k) writer.write(frame_of(k));
    writer.flush();
  }
  EXPECT_THROW(FrameWriter(folder.path, 2, 1, 9), BadFile);
  std::ofstream(folder.path / "frames.h5") << "nonsense";
  EXPECT_THROW(frames_in(folder.path), BadFile);
}

// Of a file whose writer was killed HDF5 reads a damaged block again and again, after pauses that double.
TEST(FrameStore, DamageEndsWithinSecondsInOneLine) {
  const Folder folder;
  const fs::path file = folder.path / "frames.h5";
  write_frames(folder.path, 600);
  const std::string whole = text_of(file);
  std::mt19937 random(1);
  int refused = 0;
  for (int k = 0; k < 60; ++k) {
    std::string damaged = whole;
    damaged[random() % (k % 2 == 0 ? 800 : damaged.size())] ^= static_cast<char>(1 + random() % 255);
    std::ofstream(file, std::ios::binary) << damaged;
    const auto start = std::chrono::steady_clock::now();
    try {
      frames_in(folder.path);
    } catch (const BadFile& bad) {
      ++refused;
      EXPECT_EQ(std::string(bad.what()).find('\n'), std::string::npos) << bad.what();
    }
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10)) << k;
  }
  EXPECT_GT(refused, 10);
}

// Frames and poses carry checks: no flipped bit is replayed.
TEST(FrameStore, AFlippedBitIsNoticed) {
  const Folder folder;
  const fs::path file = folder.path / "frames.h5";
  constexpr long count = 40;
  write_frames(folder.path, count);
  const std::string whole = text_of(file);
  const auto read_damaged = [&](std::size_t at, int bit) -> std::optional<std::vector<Frame>> {
    std::string damaged = whole;
    damaged[at] ^= static_cast<char>(1 << bit);
    std::ofstream(file, std::ios::binary) << damaged;
    try {
      return frames_in(folder.path);
    } catch (const BadFile&) {
      return {};
    }
  };
  std::mt19937 random(3);
  for (int k = 0; k < 40; ++k)
    if (const auto frames = read_damaged(random() % whole.size(), static_cast<int>(random() % 8))) {
      ASSERT_EQ(frames->size(), static_cast<std::size_t>(count));
      for (long f = 0; f < count; ++f) expect_same((*frames)[static_cast<std::size_t>(f)], frame_of(f));
    }
  // The position of a god object in frame 31, in the dataset of poses itself.
  const double x = frame_of(31).god[0].position.x();
  const std::string in_file(reinterpret_cast<const char*>(&x), sizeof x);
  int poses = 0;
  for (std::size_t at = whole.find(in_file); at != std::string::npos; at = whole.find(in_file, at + 1), ++poses)
    EXPECT_FALSE(read_damaged(at, 3)) << at;
  EXPECT_GE(poses, 3) << "target, god and loose";
}

TEST(FrameStore, CheckpointsComeBackToTheBit) {
  const Folder folder;
  EXPECT_EQ(read_checkpoint(folder.path).frames, 0);
  const std::vector<double> state = {0.1, -0.0, 5e-324, 1.0 / 3};
  write_checkpoint(folder.path, {1500, state});
  const Checkpoint back = read_checkpoint(folder.path);
  EXPECT_EQ(back.frames, 1500);
  ASSERT_EQ(back.state.size(), state.size());
  EXPECT_EQ(std::memcmp(back.state.data(), state.data(), state.size() * sizeof(double)), 0);
  std::string damaged = text_of(folder.path / "checkpoint.h5");
  const std::string third(reinterpret_cast<const char*>(&state[3]), sizeof(double));
  damaged[damaged.find(third)] ^= 1;
  std::ofstream(folder.path / "checkpoint.h5", std::ios::binary) << damaged;
  EXPECT_THROW(read_checkpoint(folder.path), BadFile);
  std::ofstream(folder.path / "checkpoint.h5") << "nonsense";
  EXPECT_THROW(read_checkpoint(folder.path), BadFile);
}

TEST(Run, ResumedEqualsUninterruptedBitByBit) {
  const Folder folder;
  Record record;
  record.asked = {.scene = "box", .motion = "slide", .frames = checkpoint_every + 320};
  record.asked.options.verify = false;
  const auto setup = set_up(record);
  const std::atomic<bool> never = false;
  for (const char* name : {"whole", "stopped"}) fs::create_directories(folder.path / name);
  EXPECT_EQ(simulate(
                folder.path / "whole", record, setup, false, [](double, const std::string&) {}, never),
            record.asked.frames);

  // Stopped well after the checkpoint: those frames are done again.
  std::atomic<bool> now = false;
  long seen = 0;
  const long stopped = simulate(
      folder.path / "stopped", record, setup, false,
      [&](double, const std::string&) { now = ++seen == checkpoint_every + 200; }, now);
  EXPECT_EQ(stopped, checkpoint_every + 200);
  EXPECT_EQ(simulate(
                folder.path / "stopped", record, setup, true, [](double, const std::string&) {}, never),
            record.asked.frames);
  const std::vector<Frame> whole = frames_in(folder.path / "whole"), resumed = frames_in(folder.path / "stopped");
  ASSERT_EQ(whole.size(), static_cast<std::size_t>(record.asked.frames));
  ASSERT_EQ(resumed.size(), whole.size());
  for (std::size_t k = 0; k < whole.size(); ++k) expect_same(whole[k], resumed[k]);

  record.asked.audit = true;
  const Finished finished = finish(folder.path / "whole", record, setup, [](double, const std::string&) {});
  EXPECT_TRUE(fs::exists(finished.replay));
  EXPECT_NE(text_of(folder.path / "whole" / "summary.json").find("\"overlaps\": 0"), std::string::npos);
}

TEST(Run, RecordComesBack) {
  const Folder folder;
  Record record;
  record.asked = {.scene = "wall", .motion = "press", .share = 0.5, .frames = 12, .audit = true};
  record.asked.options = chosen({.commit = Options::Commit::printed, .force_cap = 12});
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
  // Values that the command line would not take either.
  const std::string good = text_of(folder.path / "run.json");
  for (const auto& [was, is] : {std::pair{R"("sub_steps": 3)", R"("sub_steps": 0)"},
                                {R"("gap": 0.0002)", R"("gap": 0.0)"},
                                {R"("gap": 0.0002)", R"("gap": 2.0)"},
                                {R"("force_stiffness": 10000.0)", R"("force_stiffness": -1.0)"},
                                {R"("commit": "printed")", R"("commit": "print")"},
                                {R"("clusters": true)", R"("clusters": "on")"},
                                {R"("share": 0.5)", R"("share": 1.5)"},
                                {R"("title")", R"("no title")"}}) {
    ASSERT_NE(good.find(was), std::string::npos) << was;
    std::string bad = good;
    std::ofstream(folder.path / "run.json") << bad.replace(bad.find(was), std::string(was).size(), is);
    EXPECT_THROW(read_record(folder.path), BadFile) << is;
  }
  std::ofstream(folder.path / "run.json") << "{";
  EXPECT_THROW(read_record(folder.path), BadFile);
}

}  // namespace
}  // namespace zwang::god
