#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/run/run.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/god_hand/tools/mechanism.h>
#include "tests/folders.h"
#include "tests/god_hand/tools/written.h"

namespace zwang::god {
namespace {

const std::filesystem::path examples = source_dir() / "docs/examples";
const std::string fingers = (examples / "scenes/fingers.json").string();

std::string scene(const std::string& bodies, const std::string& joints, const std::string& limits = "") {
  return "{\"format\": \"zwang scene 1\",\n\"bodies\": [" + bodies + "],\n\"joints\": [" + joints +
         "],\n\"limits\": [" + limits + "]}";
}

std::string numbered(std::string text, int number) { return text.append(std::to_string(number)); }

// Rods along y, the first one's middle at (0, 0.05, 0), each hung on the end of the one before.
std::string rod(const std::string& name, int number) {
  return "{\"name\": \"" + name + "\", \"mass\": 0.1, \"shape\": {\"capsule\": [0.06, 0.008]}, \"position\": [0, " +
         std::to_string(0.05 + 0.1 * number) + ", 0]}";
}
const std::string rods = rod("a", 0) + ",\n" + rod("b", 1) + ",\n" + rod("c", 2);
std::string hinge(const std::string& name, const std::string& a, const std::string& b, double y,
                  const std::string& more = "") {
  return "{\"name\": \"" + name + "\", \"type\": \"hinge\", \"a\": \"" + a + "\", \"b\": \"" + b + "\", \"at\": [0, " +
         std::to_string(y) + ", 0], \"axis\": [0, 0, 1]" + more + "}";
}

TEST(SceneMechanism, ThreeFingersTakeABoxAndLiftIt) {
  const Tool tool = make_tool(fingers);
  ASSERT_EQ(tool.objects.shapes.size(), 7u);
  const std::optional<HandMotion> motion = read_path(examples / "god-hand/fingers.csv", tool);
  ASSERT_TRUE(motion);
  const Surroundings s = make_surroundings("box", "");
  Options options;
  options.verify = 0;
  Play play(s, *motion, options, &tool);
  Kept kept;
  double grip = 0, high = 0, turned = 0;
  for (long k = 0; k <= 2400; ++k) {
    const Frame& f = play.step(k);
    kept.add(f);
    grip = std::max(grip, f.grip);
    if (k == 2400) high = f.loose[0].position.z();
    if (k == 1390) turned = angle_of(tool, "first_base", f.god);
  }
  EXPECT_GT(kept.gap, 0);
  EXPECT_LE(kept.joints, 1e-9);
  EXPECT_LE(kept.limits, 1e-9);
  EXPECT_GT(grip, 1);
  EXPECT_NEAR(high, 0.0301 + 0.1, 0.01);
  EXPECT_GT(turned, 0.05);
  EXPECT_LT(turned, 0.29);  // its target is inside the box
}

TEST(SceneMechanism, MotionsOfAHandBendIt) {
  const Tool tool = make_tool(fingers);
  const Surroundings s = make_surroundings("box", "");
  const HandMotion motion = synthetic_motion("grasp", s);
  Play play(s, motion, unverified(), &tool);
  Kept kept;
  for (long k = 0; k < static_cast<long>(1e3 * motion.duration); ++k) kept.add(play.step(k));
  EXPECT_GT(kept.gap, 0);
  EXPECT_LE(kept.joints, 1e-9);
  EXPECT_LE(kept.limits, 1e-9);
}

// The end of a finger turns with its base: its target is where both have taken it.
TEST(SceneMechanism, DrivesComposeAlongTheTree) {
  const std::string joints =
      hinge("h", "a", "b", 0.1, ", \"drive\": 0.5") + "," + hinge("i", "b", "c", 0.2, ", \"drive\": 0.25");
  const Tool tool = tool_of(scene(rods, joints), ".json");
  const std::vector<Pose<double>> poses = tool.poses(closed(1, posed(1, 2, 3)));
  EXPECT_NEAR(angle_of(tool, "h", poses), 0.5, 1e-14);
  EXPECT_NEAR(angle_of(tool, "i", poses), 0.25, 1e-14);
  // From the root's middle: 50 mm to the first hinge, 100 mm to the second, 50 mm to the middle of the last rod.
  const Vec3 expected =
      Vec3(1, 2.05, 3) + 0.1 * Vec3(-std::sin(0.5), std::cos(0.5), 0) + 0.05 * Vec3(-std::sin(0.75), std::cos(0.75), 0);
  EXPECT_LE((poses[2].position - expected).norm(), 1e-14);
  EXPECT_LE((poses[0].position - Vec3(1, 2, 3)).norm(), 1e-15);
}

// Written down from the end to the root, the same mechanism.
TEST(SceneMechanism, JointsMayBeWrittenDownTheOtherWay) {
  const std::string limits = "{\"joint\": \"h\", \"low\": -0.2, \"high\": 0.3}";
  const auto read = [&](const std::string& first, const std::string& second, double sign) {
    const std::string drive = numbered(", \"drive\": ", static_cast<int>(sign));
    return tool_of(scene(rods,
                         first == "ab" ? hinge("h", "a", "b", 0.1, drive) + "," + hinge("i", "b", "c", 0.2)
                                       : hinge("i", "c", "b", 0.2) + "," + hinge("h", "b", "a", 0.1, drive),
                         second),
                   ".json");
  };
  const Tool forward = read("ab", limits, 1);
  // a's angle against b is the negative of b's against a.
  const Tool backward = read("ba", "{\"joint\": \"h\", \"low\": -0.3, \"high\": 0.2}", -1);
  for (const double angle : {-1.0, 0.1, 0.7}) {
    const auto f = forward.poses(closed(angle)), b = backward.poses(closed(angle));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LE((f[k].position - b[k].position).norm(), 1e-14) << angle << ' ' << k;
    const Target target = closed(angle);
    HandMotion motion{.name = "bend", .hands = {Track{.model = hand::standard()}}, .duration = 1};
    append(motion.hands[0], {0, closed(0)});
    append(motion.hands[0], {0.1, target});
    append(motion.hands[0], {1, target});
    motion.hands[0].patience = 2;
    for (const Tool* tool : {&forward, &backward}) {
      Play play({.name = "nothing"}, motion, unverified(), &*tool);
      for (long s = 0; s < 400; ++s) play.step(s);
      const Frame& frame = play.step(400);
      EXPECT_NEAR(angle_of(forward, "h", frame.god), std::clamp(angle, -0.2, 0.3), 1e-9);
      EXPECT_LE(frame.limit, 1e-9);
      EXPECT_LE(frame.separation, 1e-12);
    }
  }
}

TEST(SceneMechanism, BallsUniversalJointsAndWeldsHold) {
  const std::string joints =
      R"({"type": "ball", "a": "b", "b": "a", "at": [0, 0.1, 0]}, {"type": "universal", "a": "c", "b": "b", "at": [0, 0.2, 0],
        "axis": [1, 0, 0], "axis_b": [0, 0, 1]}, {"type": "weld", "a": "d", "b": "c", "at": [0, 0.3, 0]})";
  const Tool tool = tool_of(scene(rods + ",\n" + rod("d", 3), joints), ".json");
  HandMotion motion{.name = "swing", .hands = {Track{.model = hand::standard()}}, .duration = 1};
  append(motion.hands[0], {0, {.palm = posed(0, 0, 0.3)}});
  append(motion.hands[0], {0.5, {.palm = posed(0, 0, -0.1, {0.5, 0, 0.3})}});
  motion.hands[0].patience = 2;
  Play play(floor_of(), motion, unverified(), &tool);
  Kept kept;
  for (long k = 0; k <= 500; ++k) kept.add(play.step(k));
  EXPECT_GT(kept.gap, 0);
  EXPECT_LE(kept.joints, 1e-9);
}

TEST(SceneMechanism, ARangeOfMoreThanHalfATurnIsKept) {
  const Tool tool = tool_of(scene(rods, hinge("h", "a", "b", 0.1, ", \"drive\": 1") + "," + hinge("i", "b", "c", 0.2),
                                  R"({"joint": "h", "low": -2.5, "high": 2.5})"),
                            ".json");
  HandMotion motion{.name = "turn", .hands = {Track{.model = hand::standard()}}, .duration = 6};
  motion.hands[0].patience = 10;
  append(motion.hands[0], {0, closed(0)});
  append(motion.hands[0], {2, closed(3)});
  append(motion.hands[0], {6, closed(-3)});
  Play play({.name = "nothing"}, motion, unverified(), &tool);
  double most = 0, least = 0;
  for (long k = 0; k <= 6000; ++k) {
    const Frame& f = play.step(k);
    ASSERT_LE(f.limit, 1e-9) << k;
    const double angle = angle_of(tool, "h", f.god);
    most = std::max(most, angle), least = std::min(least, angle);
  }
  EXPECT_NEAR(most, 2.5, 1e-9);
  EXPECT_NEAR(least, -2.5, 1e-9);
}

TEST(SceneMechanism, APathSetsHingesByName) {
  const Tool tool = make_tool(fingers);
  const std::string head = "time,x,y,z,qw,qx,qy,qz,close,first_base,thumb_end\n";
  const Written file(head + "0,0,0,0.5,1,0,0,0,0,0,0\n1,0,0,0.5,1,0,0,0,1,-0.2,2\n", ".csv");
  const std::optional<HandMotion> motion = read_path(file.path, tool);
  ASSERT_TRUE(motion);
  const std::vector<Pose<double>> half = tool.poses(motion->hands[0].at(0.5));
  EXPECT_NEAR(angle_of(tool, "first_base", half), -0.1, 1e-12);
  EXPECT_NEAR(angle_of(tool, "first_end", half), 0.1, 1e-12);
  EXPECT_NEAR(angle_of(tool, "thumb_end", half), 1, 1e-12);
  Play play({.name = "nothing"}, *motion, unverified(), &tool);
  for (long k = 0; k < 1000; ++k) play.step(k);
  const Frame& f = play.step(1000);
  EXPECT_NEAR(angle_of(tool, "thumb_end", f.god), 1.5, 1e-9);  // its limit; its target is beyond
  EXPECT_NEAR(angle_of(tool, "thumb_end", tool.poses(motion->hands[0].at(1))), 2, 1e-9);
  const Written wrong("time,x,y,z,qw,qx,qy,qz,first_bas\n0,0,0,0.5,1,0,0,0,0\n1,0,0,0.5,1,0,0,0,0\n", "-wrong.csv");
  try {
    read_path(wrong.path, tool);
    FAIL();
  } catch (const BadFile& bad) {
    EXPECT_NE(std::string(bad.what()).find("unknown column 'first_bas'; did you mean 'first_base'?"), std::string::npos)
        << bad.what();
  }
  // A line without the hinge's angle is a line without a pose.
  const Written gap(head + "0,0,0,0.5,1,0,0,0,0,0,0\n1,0,0,0.5,1,0,0,0,1,,2\n2,0,0,0.5,1,0,0,0,1,0,2\n", "-gap.csv");
  EXPECT_EQ(read_path(gap.path, tool)->hands[0].held_over, 1u);
}

TEST(SceneMechanism, TheAxesOfAFileMayBeOthers) {
  const std::string text = scene(rods, hinge("h", "a", "b", 0.1, ", \"drive\": 0.5") + "," + hinge("i", "b", "c", 0.2));
  const Written file(text, ".json");
  const Tool plain = make_tool(file.path.string()), turned = make_tool(file.path.string() + "@-x+y");
  // The file's -x is the palm's y, its y the palm's z: the rods point out of the back of the hand.
  const auto p = plain.poses(closed(1)), t = turned.poses(closed(1));
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 x = p[k].position;
    EXPECT_LE((t[k].position - Vec3(-x.z(), -x.x(), x.y())).norm(), 1e-14) << k;
  }
  for (const char* wrong : {"@xx", "@x", "@xyz", "@mm", "@x,y"})
    EXPECT_THROW(make_tool(file.path.string() + wrong), std::invalid_argument) << wrong;
}

TEST(SceneMechanism, WhatItCannotBeIsRefusedInOneLine) {
  const std::string joints = hinge("h", "a", "b", 0.1) + ",\n" + hinge("i", "b", "c", 0.2);
  const auto with = [&](const std::string& type, const std::string& more = "") {
    return scene(rods, hinge("h", "a", "b", 0.1) + ",\n{\"type\": \"" + type +
                           "\", \"a\": \"b\", \"b\": \"c\", \"at\": [0, 0.2, 0], \"axis\": [0, 0, 1]" + more + "}");
  };
  const std::string other = "\", \"a\": \"b\"";
  std::string many, chain;
  for (int k = 0; k < 63; ++k) {
    const std::string name = numbered("r", k);
    many.append(k ? ",\n" : "").append(rod(name, k));
    if (k == 0) continue;
    chain.append(k > 1 ? ",\n" : "").append(hinge(numbered("h", k), numbered("r", k - 1), name, 0.1 * k));
  }
  const std::string bare = R"({"name": "c", "mass": 0.1})",
                    fixed = R"({"name": "c", "motion": "fixed", "shape": {"sphere": 0.1}})";
  const struct {
    std::string text, expected;
  } cases[] = {
      {scene(rods, joints), ""},
      {with("slider"), ", line 6: /joints/1/type: expected ball, hinge, universal or weld in a god object"},
      {with("distance", ", \"length\": 1"),
       ", line 6: /joints/1/type: expected ball, hinge, universal or weld in a god object"},
      {with("rope", ", \"length\": 1"),
       ", line 6: /joints/1/type: expected ball, hinge, universal or weld in a god object"},
      {with("ball", ", \"drive\": 1"), ", line 6: /joints/1/drive: expected a hinge beside it"},
      {scene(rods, joints + ",\n" + hinge("j", "c", "a", 0.3)),
       ", line 7: /joints/2: expected no loop: 'j' joins bodies of a god object that are joined already"},
      {scene(rods, hinge("h", "a", "b", 0.1)), ", line 4: /bodies/2: expected a body that joints connect with 'a'"},
      {scene(rod("a", 0) + ",\n" + rod("b", 1) + ",\n" + bare, joints),
       ", line 4: /bodies/2: expected a member 'shape': a god object meets things"},
      {scene(rod("a", 0) + ",\n" + rod("b", 1) + ",\n" + fixed, joints),
       ", line 4: /bodies/2/motion: expected \"free\": what is moved as a god object has no other motion"},
      {scene("", ""), ", line 2: /bodies: expected a body among them"},
      {scene(many, chain), ", line 2: /bodies: expected at most 62 in a god object"},
      {scene(rods, joints, R"({"joint": "h", "low": -4, "high": 4})"),
       ", line 7: /limits/0/high: expected less than a turn above low (rad)"}};
  for (const auto& [text, expected] : cases) EXPECT_EQ(refusal(text, ".json"), expected);
  EXPECT_THROW(make_tool("nowhere.json"), BadFile);
}

// Bodies that overlap at rest, or hang on one another, do not meet; the two ends of a chain do.
TEST(SceneMechanism, ItDoesNotTouchItselfAtRestAndMeetsItselfElsewhere) {
  std::string joints;
  std::string bodies = rods + ",\n" + rod("d", 3) + R"(,
    {"name": "e", "mass": 0.1, "shape": {"sphere": 0.02}, "position": [0, 0.25, 0.02]})";
  for (const auto& [a, b, y] : {std::tuple{"a", "b", 0.1}, {"b", "c", 0.2}, {"c", "d", 0.3}, {"b", "e", 0.2}})
    joints += (joints.empty() ? "" : ",") + hinge(std::string("h") + b, a, b, y, ", \"drive\": 1");
  const Tool tool = tool_of(scene(bodies, joints), ".json");
  const std::vector<collision::Filter>& filters = tool.objects.filters;
  EXPECT_FALSE(filters[0].meets(filters[1]));
  EXPECT_TRUE(filters[0].meets(filters[2]));
  EXPECT_TRUE(filters[0].meets(filters[3]));
  EXPECT_FALSE(filters[2].meets(filters[4]));  // they overlap
  // All hinges by 2 rad: the chain curls up into itself.
  HandMotion motion{.name = "curl", .hands = {Track{.model = hand::standard()}}, .duration = 1};
  motion.hands[0].patience = 2;
  append(motion.hands[0], {0, closed(2)});
  append(motion.hands[0], {1, closed(2.2)});
  Play play({.name = "nothing"}, motion, unverified(), &tool);
  Kept kept;
  for (long k = 0; k <= 1000; ++k) kept.add(play.step(k));
  EXPECT_GT(kept.gap, 0);
  EXPECT_LE(kept.joints, 1e-9);
}

TEST(SceneMechanism, ARunKnowsItsGodObject) {
  const std::string text = text_of(fingers);
  const auto of = [&](const std::string& was, const std::string& is) {
    std::string changed = text;
    if (!was.empty()) changed.replace(changed.find(was), was.size(), is);
    const Written file(changed, ".json");
    Record record;
    record.asked = {.scene = "box", .god = file.path.string(), .motion = "grasp", .frames = 2};
    set_up(record);
    return record.god;
  };
  const std::uint64_t first = of("", "");
  EXPECT_EQ(of("", ""), first);
  EXPECT_NE(of("\"drive\": 0.2", "\"drive\": 0.25"), first);
  EXPECT_NE(of("\"high\": 1.2", "\"high\": 1.1"), first);
  EXPECT_NE(of("\"mass\": 0.3", "\"mass\": 0.4"), first);
  EXPECT_NE(of("[0.05, 0.008]", "[0.05, 0.009]"), first);
  EXPECT_EQ(of("\"name\": \"fingers\"", "\"name\": \"three fingers\""), first);
}

}  // namespace
}  // namespace zwang::god
