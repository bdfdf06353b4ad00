#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/god_hand/motion/motions.h>
#include "tests/god_hand/leap_document.h"
#include "tests/recorded_data.h"

namespace zwang::god {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> columns(const std::string& prefix) {
  std::vector<std::string> names;
  for (const char* name : {"palm_x", "palm_y", "palm_z", "palm_qw", "palm_qx", "palm_qy", "palm_qz"})
    names.push_back(prefix + name);
  for (int a = 0; a < hand::angles; ++a) {
    std::string name = hand::angle_name(a);
    std::replace(name.begin(), name.end(), ' ', '_');
    names.push_back(prefix + name);
  }
  return names;
}

using Lines = std::vector<std::vector<std::string>>;

// Ten rows of hands that move along x and curl, as cells.
Lines table(const std::vector<std::string>& prefixes) {
  Lines lines(11);
  lines[0] = {"time"};
  for (int k = 1; k <= 10; ++k) lines[static_cast<std::size_t>(k)] = {std::to_string(5 + 0.01 * k)};
  for (const std::string& prefix : prefixes) {
    for (const std::string& name : columns(prefix)) lines[0].push_back(name);
    for (std::size_t k = 1; k < lines.size(); ++k) {
      for (const double v : {0.01 * static_cast<double>(k), 0.2, 0.3, 0.8, 0.0, 0.6, 0.0})
        lines[k].push_back(std::to_string(v));
      for (int a = 0; a < hand::angles; ++a)
        lines[k].push_back(std::to_string(a % 4 == 1 ? 0.05 : 0.03 * static_cast<double>(k)));
    }
  }
  return lines;
}

std::string text(const Lines& lines) {
  std::ostringstream out;
  for (const auto& line : lines)
    for (std::size_t k = 0; k < line.size(); ++k) out << line[k] << (k + 1 < line.size() ? "," : "\n");
  return out.str();
}

TEST(JointTable, OwnColumnsAreTakenAsTheyAre) {
  const HandMotion motion = read_motion(written("angles.csv", text(table({""}))));
  ASSERT_EQ(motion.hands.size(), 1u);
  const Track& track = motion.hands[0];
  EXPECT_EQ(motion.name, "angles");
  EXPECT_NEAR(motion.duration, 0.09, 1e-9);
  ASSERT_EQ(track.keys.size(), 10u);
  EXPECT_EQ(track.keys[3].target.palm.position, Vec3(0.04, 0.2, 0.3));
  EXPECT_NEAR(track.keys[3].target.palm.rotation(0, 2), 0.96, 1e-12);
  EXPECT_EQ(track.keys[3].target.angles[4], 0.12);
  EXPECT_EQ(track.misfit_most, 0);
  EXPECT_EQ(track.beyond, 0);
}

TEST(JointTable, TwoHandsByPrefixInAnyOrder) {
  const HandMotion motion = read_motion(written("angles.csv", text(table({"left_", "right_"}))));
  ASSERT_EQ(motion.hands.size(), 2u);
  EXPECT_FALSE(motion.hands[0].model.left);
  EXPECT_TRUE(motion.hands[1].model.left);
}

TEST(JointTable, AnglesBeyondTheLimitsAreClampedAndMeasured) {
  Lines lines = table({""});
  lines[4][8 + 4] = "1.8";  // index MCP flexion: at most pi/2
  const Track track = read_motion(written("angles.csv", text(lines))).hands[0];
  EXPECT_NEAR(track.beyond, 1.8 - 1.5707963267948966, 1e-12);
  EXPECT_EQ(track.keys[3].target.angles[4], track.model.range(4).high);
  EXPECT_EQ(read_motion(written("angles.csv", text(lines))).notes.at(0),
            "angles up to 0.229 rad beyond the hand's limits: clamped");
  // The whole straight-ish finger swings by 0.229 rad.
  EXPECT_GT(track.misfit_most, 0.01);
  EXPECT_LT(track.misfit_most, 0.02);
}

TEST(JointTable, NaNRowsAreHeldOver) {
  Lines lines = table({""});
  lines[4][3] = "nan";
  lines[5][20] = "";
  lines[6][4] = "0.1";  // a quaternion that is none
  lines[7][0] = "NaN";
  lines[8][3] = "2147483647";  // a palm beyond the moon: where it is placed was searched for ever
  const HandMotion motion = read_motion(written("angles.csv", text(lines)));
  EXPECT_EQ(motion.hands[0].held_over, 4u);
  EXPECT_EQ(motion.hands[0].keys.size(), 9u);
  EXPECT_FALSE(motion.hands[0].keys[4].target.tracked);
  EXPECT_EQ(motion.hands[0].keys[4].target.palm.position.x(), 0.03);
  EXPECT_EQ(motion.notes.size(), 2u);
}

TEST(JointTable, AnAngleOfSeveralTurnsIsHeldOver) {
  Lines lines = table({""});
  lines[4][12] = "90";
  const Track track = read_motion(written("angles.csv", text(lines))).hands[0];
  EXPECT_EQ(track.held_over, 1u);
  EXPECT_EQ(track.beyond, 0);
}

TEST(JointTable, ARecordingWhoseFirstPoseCannotBeFollowedBeginsLater) {
  std::string names = "step,ARRx,ARRy,ARRz,palm_x,palm_y,palm_z,WRJ1,WRJ0,LFJ4";
  for (const char* finger : {"FF", "MF", "RF", "LF"})
    for (int k = 0; k < 4; ++k) names += "," + std::string(finger) + "J" + std::to_string(k);
  const auto row = [](int step, const std::string& thumb) {
    return "\n" + std::to_string(step) + ",0,0,0,0,0.1,0.2,0,0,0" +
           [] {
             std::string angles;
             for (int k = 0; k < 16; ++k) angles += ",0.1";
             return angles;
           }() +
           "," + thumb + ",0,0,0,0";
  };
  names += ",THJ0,THJ1,THJ2,THJ3,THJ4";
  const HandMotion motion =
      read_motion(written("adroit.csv", names + row(0, "-1e308") + row(1, "0") + row(2, "0") + row(3, "0") + "\n"));
  EXPECT_EQ(motion.hands.at(0).held_over, 1u);
  EXPECT_EQ(motion.hands.at(0).keys.size(), 3u);
  EXPECT_TRUE(std::isfinite(motion.hands.at(0).misfit_mean));
  const std::string never = motion_refusal(names + row(0, "-1e308") + row(1, "-1e308") + "\n", "angles.csv");
  EXPECT_NE(never.find("most rows are not whole"), std::string::npos) << never;
}

TEST(JointTable, RefusesInOneLine) {
  const auto changed = [](auto change) {
    Lines lines = table({""});
    change(lines);
    return text(lines);
  };
  const std::pair<std::string, std::string> cases[] = {
      {"\n\n", "an empty file"},
      {"\xff\xfet", "UTF-16; text in UTF-8 expected"},
      {"time\n", "no motion"},
      {"a,b\n1,2\n3,4\n", "unknown column 'a'"},
      {changed([](Lines& l) { l[0][9] = "thumb_CMC_abductoin"; }),
       "unknown column 'thumb_CMC_abductoin'; did you mean 'thumb_CMC_abduction'?"},
      {changed([](Lines& l) {
         for (auto& line : l) line.erase(line.begin() + 12);
       }),
       "no column 'index_MCP_flexion'"},
      {changed([](Lines& l) {
         for (auto& line : l) line.erase(line.begin());
       }),
       "no column 'time'"},
      {changed([](Lines& l) { l[0][9] = l[0][8]; }), "is there twice"},
      {changed([](Lines& l) { l[3].pop_back(); }), "line 4: 27 columns, the header has 28"},
      {changed([](Lines& l) { l[3][7] = "fast"; }), "line 4: column 'palm_qz' is 'fast', a number expected"},
      {changed([](Lines& l) { l[3][7] = "0x1"; }), "a number expected"},
      {changed([](Lines& l) {
         for (std::size_t k = 1; k < 8; ++k) l[k][9] = "nan";
       }),
       "most rows have a NaN"},
      {changed([](Lines& l) {
         for (std::size_t k = 1; k < 8; ++k) l[k][0] = "";
       }),
       "most rows have no time"},
      {changed([](Lines& l) { l[5][0] = "1e7"; }), "more than 10 minutes"},
      {changed([](Lines& l) {
         for (std::size_t k = 1; k < l.size(); ++k) l[k][0] = "5";
       }),
       "all rows have one time"},
      {changed([](Lines& l) {
         for (std::size_t k = 1; k < l.size(); ++k) l[k][12] = "30";
       }),
       "an angle more than a turn beyond its limits"},
      {changed([](Lines& l) {
         for (std::size_t k = 1; k < l.size(); ++k) l[k][1] = std::to_string(10 * k);
       }),
       "the palm goes at 1e+03 m/s"},
      {changed([](Lines& l) {
         for (std::size_t k = 1; k < l.size(); ++k) l[k][0] = std::to_string(11 * k);
       }),
       "less than a row in two seconds; seconds expected"},
      {changed([](Lines& l) {
         for (std::size_t k = 1; k < l.size(); ++k) l[k][0] = std::to_string(k), l[k][1] = std::to_string(15 * k);
       }),
       "the palm is 45 m and more from its usual place in half of the rows; metres expected"},
      {"time;palm_x;palm_y\n0;1;2\n1;2;3\n", "line 1: no commas"},
      {"step,FFJ2\n0,1\n1,2\n", "no column 'FFJ3'"},
  };
  for (const auto& [content, expected] : cases) {
    const std::string line = motion_refusal(content, "angles.csv");
    EXPECT_NE(line.find(expected), std::string::npos) << expected << " | " << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
}

TEST(JointTable, RealAdroitRecordingsAreFollowedWithinMillimetres) {
  const fs::path folder = test::recorded_data() / "motion_dapg_door";
  if (!fs::exists(folder)) GTEST_SKIP() << "no motion_dapg_door in ZWANG_DATA or beside the sources";
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".csv") continue;
    ++files;
    const HandMotion motion = read_motion(entry.path());
    const Track& track = motion.hands.at(0);
    std::printf("%s: misfit %.2f mm, at most %.2f; %.3f rad beyond its limits\n", motion.name.c_str(),
                1e3 * track.misfit_mean, 1e3 * track.misfit_most, track.beyond);
    EXPECT_LT(track.misfit_mean, 2e-3);
    EXPECT_LT(track.misfit_most, 15e-3);
    EXPECT_GT(track.beyond, 0.01);
    EXPECT_LT(track.beyond, 0.1);
    EXPECT_NEAR(motion.duration, 0.01 * static_cast<double>(track.keys.size() - 1), 1e-9);
    // No angle flips from one frame to the next.
    for (std::size_t k = 1; k < track.keys.size(); ++k)
      for (std::size_t a = 0; a < 20; ++a)
        EXPECT_LT(std::abs(track.keys[k].target.angles[a] - track.keys[k - 1].target.angles[a]), 0.4);
  }
  EXPECT_GT(files, 0);
}

}  // namespace
}  // namespace zwang::god
