#include <gtest/gtest.h>
#include <zlib.h>

#include <random>

#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/god_hand/motion/motions.h>
#include "tests/god_hand/leap_document.h"
#include "tests/recorded_data.h"

namespace zwang::god {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

HandMotion read(const Json& document, const std::string& name = "recording.json") {
  return read_motion(written(name, document.dump()));
}

void expect_sound(const HandMotion& motion) {
  EXPECT_FALSE(motion.hands.empty());
  for (const Track& track : motion.hands) {
    double before = -1;
    for (const Track::Key& key : track.keys) {
      EXPECT_GT(key.time, before);
      before = key.time;
      ASSERT_TRUE(key.target.palm.position.allFinite() && key.target.palm.rotation.allFinite());
      EXPECT_LE((key.target.palm.rotation.transpose() * key.target.palm.rotation - Mat3::Identity()).norm(), 1e-12);
      for (int a = 0; a < hand::angles; ++a) {
        const hand::Range limit = track.model.range(a);
        const double angle = key.target.angles[static_cast<std::size_t>(a)];
        EXPECT_TRUE(angle >= limit.low && angle <= limit.high) << hand::angle_name(a) << " " << angle;
      }
    }
  }
}

TEST(Leap, FindsTheHandsThatWroteIt) {
  const HandMotion motion = read(leap_document(60, true, true));
  ASSERT_EQ(motion.hands.size(), 2u);
  expect_sound(motion);
  EXPECT_NEAR(motion.duration, 59 * 0.0175 + 0.0006, 1e-9);
  for (const Track& track : motion.hands) {
    EXPECT_EQ(track.model.left, &track == &motion.hands[1]);
    EXPECT_EQ(track.keys.size(), 60u);
    EXPECT_EQ(track.held_over, 0u);
    EXPECT_LT(track.misfit_most, 2e-4);
    EXPECT_NEAR(track.keys[10].target.palm.position.z(), 0.19, 1e-3);
    EXPECT_NEAR(track.model.fingers[2].bone[1].length, 0.0285, 1e-9);
    EXPECT_NEAR(track.model.fingers[0].spread, (track.model.left ? -1 : 1) * 0.8727, 0.05);
  }
}

TEST(Leap, ReadsColumnsByNameInAnyOrder) {
  Json document = leap_document(20, true, false);
  for (Json& row : document["frames"]) std::swap(row[0], row[3]);
  expect_sound(read(document));
}

TEST(Leap, OfFewFramesASecondIsTrackedBetweenThem) {
  Json document = leap_document(20, true, false);
  for (std::size_t k = 1; k < document["frames"].size(); ++k) document["frames"][k][1] = 200000 * k;
  const HandMotion motion = read(document);
  EXPECT_TRUE(motion.hands[0].at(1.1).tracked);
  document["frames"].erase(6);  // a real pause: two frames
  document["frames"].erase(6);
  EXPECT_FALSE(read(document).hands[0].at(1.1).tracked);
}

TEST(Leap, SortsTimesAndDropsRepeatedOnes) {
  Json document = leap_document(20, true, false);
  std::swap(document["frames"][5], document["frames"][9]);
  document["frames"][12][1] = document["frames"][11][1];
  const HandMotion motion = read(document);
  expect_sound(motion);
  EXPECT_EQ(motion.hands[0].keys.size(), 19u);
  ASSERT_EQ(motion.notes.size(), 1u);
  EXPECT_EQ(motion.notes[0], "1 frame with the time stamp of another");
}

TEST(Leap, HoldsTornFramesOverAndSaysSo) {
  Json document = leap_document(40, true, false);
  document["frames"][7][2][0][4] = {nullptr, 1, 2};                       // palmPosition
  document["frames"][8][3][2][5][1] = "far";                              // a joint
  document["frames"][9][3].erase(4);                                      // a finger
  document["frames"][10][3][1][6][0] = 4e7;                               // finite, but no hand's
  document["frames"][11][2] = document["frames"][11][3] = Json::array();  // not seen
  std::string text = document.dump();
  text.replace(text.find("null"), 4, "NaN");
  const HandMotion motion = read_motion(written("torn.json", text));
  expect_sound(motion);
  const Track& track = motion.hands.at(0);
  EXPECT_EQ(track.held_over, 5u);
  EXPECT_EQ(track.keys.size(), 40u);
  for (std::size_t k = 6; k < 11; ++k) {
    EXPECT_FALSE(track.keys[k].target.tracked);
    EXPECT_EQ(track.keys[k].target.angles, track.keys[5].target.angles);
  }
  EXPECT_TRUE(track.keys[11].target.tracked);
  ASSERT_EQ(motion.notes.size(), 3u);
  EXPECT_EQ(motion.notes[2], "5 frames without the right hand: its last pose held over");
  EXPECT_EQ(motion.notes[0],
            "3 frames of the right hand torn: frame 7: the right hand's palmPosition is not three numbers");
}

// Trackers take one hand for the other now and then, and Unity's axes are mirrored.
TEST(Leap, AHandWithTheFingersOfTheOtherIsNone) {
  Json document = leap_document(40, true, false);
  for (std::size_t k = 5; k < 41; k += 7) document["frames"][k][2][0][1] = "left";
  const HandMotion motion = read(document);
  ASSERT_EQ(motion.hands.size(), 1u);
  EXPECT_FALSE(motion.hands[0].model.left);
  EXPECT_EQ(motion.hands[0].held_over, 6u);
  EXPECT_EQ(motion.notes.front(), "6 frames of the left hand with the fingers of the other hand");
  for (std::size_t k = 1; k < 41; ++k) document["frames"][k][2][0][1] = "left";
  EXPECT_NE(motion_refusal(document.dump(), "swapped.json").find("its hands have the fingers of the other hand"),
            std::string::npos);
}

TEST(Leap, AHandMayComeLate) {
  Json document = leap_document(40, true, true);
  for (int n = 1; n <= 15; ++n) document["frames"][static_cast<std::size_t>(n)][2].erase(1);
  const HandMotion motion = read(document);
  expect_sound(motion);
  EXPECT_EQ(motion.hands.at(1).held_over, 15u);
  EXPECT_NEAR(motion.hands.at(1).keys.front().time, 15 * 0.0175, 1e-9);
}

TEST(Leap, ReadsGzip) {
  const fs::path file = written("packed.json.gz", "");
  const std::string text = leap_document(10, true, false).dump();
  gzFile out = gzopen(file.c_str(), "wb");
  gzwrite(out, text.data(), static_cast<unsigned>(text.size()));
  gzclose(out);
  EXPECT_EQ(read_motion(file).name, "packed");
}

TEST(Leap, RefusesInOneLine) {
  const Json good = leap_document(20, true, false);
  const auto changed = [&](auto change) {
    Json document = good;
    change(document);
    return document.dump();
  };
  const auto each = [&](auto change) {
    return changed([&](Json& d) {
      for (std::size_t n = 1; n < d["frames"].size(); ++n) change(d["frames"][n]);
    });
  };
  const std::string whole = good.dump();
  const std::pair<std::string, std::string> cases[] = {
      {"", "0 bytes"},
      {"[1, 2]", "no Leap recording"},
      {R"({"frames": 3})", "no Leap recording"},
      {R"({"frames": [[]]})", "no frames after the header"},
      {R"({"frames": [{"a": 1}, []]})", "no header"},
      {R"({"frames": [["timestamp", "hands", "pointables"], []]})", "does not name its columns"},
      {R"({"frames": [[1e999], []]})", "number out of range"},
      {std::string(100000, '['), "broken off"},
      {whole.substr(0, whole.size() / 2), "broken off or torn near byte"},
      {changed([](Json& d) { d["frames"][0][3]["pointables"][0][5] = "pipPlace"; }),
       "no column 'pipPosition'; did you mean"},
      {changed([](Json& d) { d["frames"][0][1] = "time"; }), "no column 'timestamp'"},
      {each([](Json& row) { row[3].erase(2); }), "fingers in pointables are 4, 5 expected"},
      {each([](Json& row) { row[3] = Json::array({row[3][1]}); }), "fingers in pointables are 1, 5 expected"},
      {each([](Json& row) { row[3][1].erase(7); }), "frame 1: the right hand's pointables are torn"},
      {each([](Json& row) { row[2][0][2] = "north"; }), "direction is not three numbers"},
      {each([](Json& row) { row[2][0][1] = 3; }), "neither \"left\" nor \"right\""},
      {each([](Json& row) { row[2] = Json::array(); }), "no hand in three or more of its 20 frames"},
      {changed([](Json& d) {
         while (d["frames"].size() > 3) d["frames"].erase(3);
       }),
       "no hand in three or more of its 2 frames"},
      {each([](Json& row) { row[1] = 1; }), "all frames have one time stamp"},
      {each([](Json& row) { row[1] = "now"; }), "frame 1: its time stamp is no number"},
      {each([](Json& row) { row[1] = row[1].get<double>() * 1e-6; }), "microseconds expected"},
      {each([](Json& row) { row[1] = row[1].get<double>() * 1e3; }), "microseconds expected"},
      {each([](Json& row) { row[3][1][5] = row[3][1][4]; }), "mm long"},
  };
  for (const auto& [text, expected] : cases) {
    const std::string line = motion_refusal(text, "bad.json");
    EXPECT_NE(line.find(expected), std::string::npos) << expected << " | " << line;
    EXPECT_NE(line.find("bad.json: "), std::string::npos);
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
  EXPECT_NE(motion_refusal(whole, "bad.txt").find("motions are .json"), std::string::npos);
  EXPECT_NE(motion_refusal(whole, "bad.json.gz").find("gzip"), std::string::npos);
  EXPECT_THROW(read_motion("/nowhere/at/all.json"), BadFile);
  EXPECT_THROW(read_motion(fs::temp_directory_path()), BadFile);
}

// Bytes changed, cut out and doubled anywhere: it loads as something sound, or there is a line about it.
TEST(Leap, SpoiltBytesLoadSoundOrAreRefused) {
  const std::string whole = leap_document(12, true, true).dump();
  std::mt19937 random(5);
  const auto below = [&](std::size_t n) { return random() % n; };
  int refused = 0;
  for (int k = 0; k < 500; ++k) {
    std::string text = whole;
    const std::size_t at = below(text.size());
    if (k % 4 == 0)
      text.resize(at);
    else if (k % 4 == 1)
      text[at] = static_cast<char>(below(256));
    else if (k % 4 == 2)
      text.erase(at, 1 + below(40));
    else
      text[at] = "0123456789,[]{}\"-eN"[below(19)];
    try {
      expect_sound(read_motion(written("spoilt.json", text)));
    } catch (const BadFile& bad) {
      ++refused;
      EXPECT_EQ(std::string(bad.what()).find('\n'), std::string::npos);
    }
  }
  EXPECT_GT(refused, 200);
  EXPECT_LT(refused, 500);
}

TEST(Leap, RealRecordingsAreFollowedWithinMillimetres) {
  const fs::path folder = test::recorded_data() / "motion_leap_bones";
  if (!fs::exists(folder)) GTEST_SKIP() << "no motion_leap_bones in ZWANG_DATA or beside the sources";
  int hands = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".json") continue;
    const HandMotion motion = read_motion(entry.path());
    expect_sound(motion);
    for (const Track& track : motion.hands) {
      ++hands;
      std::printf("%s, %s hand: misfit %.2f mm, at most %.2f\n", motion.name.c_str(),
                  track.model.left ? "left" : "right", 1e3 * track.misfit_mean, 1e3 * track.misfit_most);
      EXPECT_LT(track.misfit_mean, 2.5e-3) << motion.name;
      EXPECT_LT(track.misfit_most, 15e-3) << motion.name;
      EXPECT_EQ(track.held_over, 0u);
    }
  }
  EXPECT_EQ(hands, 7);
}

}  // namespace
}  // namespace zwang::god
