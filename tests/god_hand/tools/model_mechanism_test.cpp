#include <cmath>
#include <regex>

#include <zwang/bench/collision/audit.h>
#include <zwang/constraints/ball_joint.h>
#include <zwang/constraints/weld.h>
#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/god_hand/tools/mechanism.h>
#include "tests/god_hand/tools/written.h"
#include "tests/recorded_data.h"

namespace zwang::god {
namespace {

std::string model(const std::string& bodies, const std::string& more = "") {
  return "<mujoco><compiler angle=\"radian\" autolimits=\"true\"/>" + more + "<worldbody>" + bodies +
         "</worldbody></mujoco>";
}

// A palm at (1, 0, 0) with a finger of two phalanxes along y.
const std::string finger = R"(
  <geom type="plane" size="1 1 1"/>
  <body name="palm" pos="1 0 0"><freejoint/>
    <geom type="box" size="0.03 0.02 0.01"/>
    <geom type="sphere" size="0.05" contype="0" conaffinity="0"/>
    <body name="first" pos="0 0.03 0">
      <joint name="base" axis="1 0 0" range="-1.2 0.3"/>
      <inertial mass="0.05" pos="0 0.02 0" diaginertia="1e-5 2e-5 3e-5"/>
      <geom type="capsule" fromto="0 0 0 0 0.04 0" size="0.008"/>
      <body name="last" pos="0 0.04 0">
        <joint name="end" axis="1 0 0" range="-1.5 0" ref="-0.1"/>
        <geom type="cylinder" fromto="0 0.01 0 0 0.03 0" size="0.008"/>
        <geom type="ellipsoid" pos="0 0.04 0" size="0.008 0.012 0.008"/>
      </body>
    </body>
  </body>)";

TEST(ModelMechanism, BodiesGeomsAndHinges) {
  const Tool tool = tool_of(model(finger), ".xml");
  ASSERT_EQ(tool.objects.shapes.size(), 4u);
  const auto& bodies = tool.objects.scene.bodies;
  EXPECT_LE(bodies[0].pose.position.norm(), 1e-12);
  EXPECT_LE((bodies[1].pose.position - Vec3(0, 0.05, 0)).norm(), 1e-12);
  EXPECT_LE((bodies[2].pose.position - Vec3(0, 0.09, 0)).norm(), 1e-12);
  EXPECT_LE((bodies[3].pose.position - Vec3(0, 0.11, 0)).norm(), 1e-12);
  EXPECT_NEAR(bodies[0].mass, 8 * 0.03 * 0.02 * 0.01 * 1000 + 4 * M_PI / 3 * 0.05 * 0.05 * 0.05 * 1000,
              1e-9);  // MuJoCo's
  EXPECT_NEAR(bodies[1].mass, 0.05, 1e-12);
  EXPECT_LE((bodies[1].pose.rotation * bodies[1].inertia * bodies[1].pose.rotation.transpose() -
             Vec3(1e-5, 2e-5, 3e-5).asDiagonal().toDenseMatrix())
                .norm(),
            1e-12);
  // The capsule's tip, and the cylinder no larger than it is.
  EXPECT_NEAR(std::abs(bodies[1].pose.turn(Vec3::UnitY()).y()), 1, 1e-12);
  for (const Vec3& corner : tool.objects.shapes[2].corners()) {
    EXPECT_LE(corner.head<2>().norm() + tool.objects.shapes[2].radius(), 0.008 + 1e-12);
    EXPECT_NEAR(std::abs(corner.z()) + tool.objects.shapes[2].radius(), 0.01, 1e-12);
  }
  // Full at 1.5 rad: the base at -1.2, the end from -0.1 to -1.5.
  const auto poses = tool.poses(closed(1.5));
  EXPECT_NEAR(angle_of(tool, "base", poses), -1.2, 1e-12);
  EXPECT_NEAR(angle_of(tool, "end", poses), -1.4, 1e-12);
  const Vec3 expected =
      Vec3(0, 0.03, 0) + 0.04 * Vec3(0, std::cos(1.2), -std::sin(1.2)) + 0.02 * Vec3(0, std::cos(2.6), -std::sin(2.6));
  EXPECT_LE((poses[2].position - expected).norm(), 1e-12);
}

TEST(ModelMechanism, APathCountsAsTheModelDoes) {
  const Tool tool = tool_of(model(finger), ".xml");
  const Written file("time,x,y,z,qw,qx,qy,qz,end\n0,0,0,0.5,1,0,0,0,-0.1\n1,0,0,0.5,1,0,0,0,-1.1\n", ".csv");
  const std::optional<HandMotion> motion = read_path(file.path, tool);
  ASSERT_TRUE(motion);
  EXPECT_NEAR(angle_of(tool, "end", tool.poses(motion->hands[0].at(0))), 0, 1e-12);
  EXPECT_NEAR(angle_of(tool, "end", tool.poses(motion->hands[0].at(1))), -1, 1e-12);
  EXPECT_NEAR(angle_of(tool, "base", tool.poses(motion->hands[0].at(1))), 0, 1e-12);
}

TEST(ModelMechanism, FollowsAndBends) {
  const Tool tool = tool_of(model(finger), ".xml");
  HandMotion motion{.name = "push", .hands = {Track{.model = hand::standard()}}, .duration = 1};
  motion.hands[0].patience = 2;
  append(motion.hands[0], {0, closed(0, posed(0, 0, 0.1))});
  append(motion.hands[0], {0.5, closed(1.6, posed(0, 0, -0.02))});
  append(motion.hands[0], {1, closed(1.6, posed(0.05, 0, -0.02))});
  Play play(floor_of(), motion, unverified(), &tool);
  Kept kept;
  for (long k = 0; k <= 1000; ++k) kept.add(play.step(k));
  EXPECT_GT(kept.gap, 0);
  EXPECT_LE(kept.joints, 1e-9);
  EXPECT_LE(kept.limits, 1e-9);
}

// Three hinges and a ball: pivots between them. A body without geoms, and one without joints.
TEST(ModelMechanism, SeveralJointsABodyWithoutGeomsAndOneWithoutJoints) {
  const Tool tool = tool_of(model(R"(
    <body name="root"><geom type="sphere" size="0.02"/>
      <body name="hip" pos="0 0.05 0"><inertial mass="0.1" pos="0 0.02 0" diaginertia="1e-5 1e-5 1e-5"/>
        <joint name="x" axis="1 0 0" range="-1 0.5"/><joint name="y" axis="0 1 0"/><joint name="z" axis="0 0 1" range="-0.2 1"/>
        <body name="shin" pos="0 0.05 0"><geom type="capsule" fromto="0 0 0 0 0.05 0" size="0.01"/>
          <body name="nothing" pos="0 0.06 0">
            <body name="foot"><geom name="sole" type="box" size="0.02 0.01 0.01"/>
              <body name="toe" pos="0 0.03 0"><joint name="t" type="ball"/><geom type="sphere" size="0.01"/></body>
            </body>
          </body>
        </body>
      </body>
    </body>)"),
                            ".xml");
  // root, two pivots, hip, shin, sole, toe.
  ASSERT_EQ(tool.objects.shapes.size(), 7u);
  Scene scene = tool.objects.scene;
  EXPECT_EQ(scene.list_of<RevoluteJoint>().all.size(), 3u);
  EXPECT_EQ(scene.list_of<Weld>().all.size(), 2u);
  EXPECT_EQ(scene.list_of<BallJoint>().all.size(), 1u);
  // As MuJoCo: about the first axis last.
  const Written file("time,x,y,z,qw,qx,qy,qz,t\n0,0,0,0.5,1,0,0,0,-0.1\n1,0,0,0.5,1,0,0,0,-1.1\n", ".csv");
  EXPECT_THROW(read_path(file.path, tool), BadFile);  // a ball is no hinge
  Target target;
  for (const Tool::Drive& drive : tool.drives)
    target.hinges.push_back(drive.name == "x" ? 0.3 : drive.name == "y" ? 0.4 : 0.5);
  const auto poses = tool.poses(target);
  const Mat3 turned = rotation({0.3, 0, 0}) * rotation({0, 0.4, 0}) * rotation({0, 0, 0.5});
  EXPECT_LE((poses[4].rotation - turned * tool.objects.scene.bodies[4].pose.rotation).norm(), 1e-12);
}

TEST(ModelMechanism, URDF) {
  const Tool tool = tool_of(R"(<robot name="two">
    <link name="base"><inertial><mass value="0.3"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>
      <collision><geometry><box size="0.06 0.04 0.02"/></geometry></collision></link>
    <link name="jaw"><inertial><origin xyz="0 0.03 0"/><mass value="0.1"/>
        <inertia ixx="1e-5" iyy="1e-5" izz="1e-5" ixy="0" ixz="0" iyz="0"/></inertial>
      <collision><origin xyz="0 0.03 0"/><geometry><box size="0.01 0.06 0.01"/></geometry></collision></link>
    <joint name="bend" type="revolute"><parent link="base"/><child link="jaw"/><origin xyz="0 0.03 0"/>
      <axis xyz="0 0 1"/><limit lower="-0.1" upper="1.5" effort="1" velocity="1"/></joint></robot>)",
                            ".urdf");
  ASSERT_EQ(tool.objects.shapes.size(), 2u);
  EXPECT_NEAR(tool.objects.scene.bodies[1].mass, 0.1, 1e-12);
  EXPECT_LE((tool.objects.scene.bodies[1].pose.position - Vec3(0, 0.06, 0)).norm(), 1e-12);
  EXPECT_NEAR(angle_of(tool, "bend", tool.poses(closed(0.6))), 0.6, 1e-12);
}

TEST(ModelMechanism, WhatItCannotBeIsRefusedInOneLine) {
  const auto on_palm = [](const std::string& inside, const std::string& more = "", const std::string& beside = "") {
    return model("<body name=\"palm\"><geom type=\"sphere\" size=\"0.02\"/>" + inside + "</body>" + beside, more);
  };
  const auto part = [](const std::string& name, const std::string& joint, const std::string& geom = "type=\"sphere\"") {
    return "<body name=\"" + name + "\" pos=\"0 0.1 0\">" + joint + "<geom " + geom +
           " size=\"0.01 0.01 0.01\"/></body>";
  };
  const std::string hinge = "<joint name=\"h\" axis=\"0 0 1\"/>";
  std::string many;
  for (int k = 0; k < 70; ++k) many += "<geom type=\"sphere\" size=\"0.01\"/>";
  const std::string loop =
      "</worldbody><equality><connect name=\"ring\" body1=\"a\" body2=\"palm\" anchor=\"0 0 "
      "0\"/></equality><worldbody>";
  const struct {
    std::string text, expected;
  } cases[] = {
      {on_palm(part("a", hinge)), ""},
      {on_palm(part("a", hinge), "", part("table", "")), ""},
      {on_palm(part("a", "<joint name=\"s\" type=\"slide\" axis=\"0 0 1\"/>")),
       ": joint 's': expected a hinge or a ball; a body slides or is free at the root alone, which follows the motion"},
      {on_palm(part("a", hinge), "", part("ball", "<freejoint/>")),
       ": body 'ball': expected one tree of bodies that move, and it is not joined to 'palm'"},
      {on_palm(part("a", hinge), "", loop), ": equality 'ring': expected none that closes a loop or holds a body"},
      {on_palm(part("a", hinge) + many),
       ": body 'palm': expected at most 62 parts up to here: geoms, and joints beyond a body's first"},
      {model("<geom type=\"plane\" size=\"1 1 1\"/>"), ": expected a body in the model"}};
  for (const auto& [text, expected] : cases) EXPECT_EQ(refusal(text, ".xml"), expected);
  EXPECT_TRUE(refusal("<mujoco><worldbody>", ".xml").starts_with(": MuJoCo says: "));
  EXPECT_TRUE(refusal("<robot", ".urdf").starts_with(": MuJoCo says: "));
  EXPECT_THROW(make_tool("nowhere.xml"), BadFile);
}

// The bits of a model, and what it excludes.
TEST(ModelMechanism, PartsMeetAsInTheModel) {
  const Tool tool = tool_of(model(R"(
    <body name="palm"><geom type="box" size="0.05 0.01 0.01"/>
      <body name="a" pos="-0.04 0.05 0"><joint axis="0 0 1"/><geom type="sphere" size="0.01"/></body>
      <body name="b" pos="0 0.05 0"><joint axis="0 0 1"/><geom type="sphere" size="0.01"/>
        <body name="b2" pos="0 0.05 0"><joint axis="0 0 1"/><geom type="sphere" size="0.01"/></body></body>
      <body name="c" pos="0.04 0.05 0"><joint axis="0 0 1"/><geom type="sphere" size="0.01" contype="2" conaffinity="2"/></body>
    </body></worldbody><contact><exclude body1="b2" body2="a"/></contact><worldbody>)"),
                            ".xml");
  ASSERT_EQ(tool.objects.shapes.size(), 5u);
  const std::vector<collision::Filter>& filters = tool.objects.filters;
  EXPECT_TRUE(filters[1].meets(filters[2]));
  EXPECT_FALSE(filters[0].meets(filters[1]));
  EXPECT_TRUE(filters[0].meets(filters[3]));
  EXPECT_FALSE(filters[1].meets(filters[3]));
  for (std::size_t b = 0; b < 4; ++b) EXPECT_FALSE(filters[b].meets(filters[4]));
}

// Through a grasp in a scene, with FCL as a witness.
void plays_soundly(const Tool& tool, const std::string& scene, const std::string& motion_name, double scale) {
  const Surroundings s = make_surroundings(scene, "");
  HandMotion motion = synthetic_motion(motion_name, s);
  motion.duration *= scale;
  const std::vector<MetPart> parts = met_parts(s);
  std::vector<Obstacle> obstacles;
  for (const MetPart& part : parts) obstacles.push_back(part.body);
  Audit audit({tool.objects.shapes}, obstacles);
  Play play(s, motion, unverified(), &tool);
  Kept kept;
  double bent = 0;
  std::vector<Pose<double>> poses;
  for (long k = 0; k < static_cast<long>(1e3 * motion.duration); ++k) {
    const Frame& f = play.step(k);
    kept.add(f);
    bent = std::max(bent, (f.god.back().rotation - f.god[0].rotation).norm());
    if (k % 10 != 0) continue;
    poses.clear();
    auto loose = f.loose.begin();
    std::vector<Pose<double>> objects;
    for (const Object& object : s.objects) objects.push_back(object.loose() ? *loose++ : object.pose);
    for (const MetPart& part : parts) poses.push_back(placed(objects[part.object], part.at));
    audit.check(f.god, poses);
  }
  EXPECT_GT(kept.gap, 0);
  EXPECT_LE(kept.joints, 1e-9);
  EXPECT_LE(kept.limits, 1e-9);
  EXPECT_GT(audit.checked(), 1000);
  EXPECT_EQ(audit.found(), 0);
  EXPECT_GT(bent, 0.1);
}

// Without the meshes of the forearm, which are not among the data.
TEST(ModelMechanism, TheShadowHandGrasps) {
  const std::filesystem::path folder = test::recorded_data() / "hand_shadow_mjcf";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  std::string text = text_of(folder / "right_hand.xml");
  text = std::regex_replace(text, std::regex("<(mesh|geom)[^>]*forearm_[^>]*/>"), "");
  text = std::regex_replace(text, std::regex("meshdir=\"assets\""),
                            "meshdir=\"" + std::filesystem::absolute(folder).string() + "\"");
  const Written file(text, ".xml");
  const Tool tool = make_tool(file.path.string() + "@x-z");
  EXPECT_EQ(tool.drives.size(), 24u);
  EXPECT_EQ(tool.objects.shapes.size(), 37u);
  double mass = 0;
  for (const Body& body : tool.objects.scene.bodies) mass += body.mass;
  EXPECT_NEAR(mass, 3.794, 1e-9);
  plays_soundly(tool, "simple", "grasp", 1);
}

// Hips of three hinges, ankles of two.
TEST(ModelMechanism, AHumanoid) {
  const std::filesystem::path file = test::recorded_data() / "mjcf/humanoid/humanoid.xml";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const Tool tool = make_tool(file.string());
  EXPECT_EQ(tool.drives.size(), 21u);
  plays_soundly(tool, "simple", "grasp", 0.25);
  const std::string crowd = (file.parent_path() / "22_humanoids.xml").string();
  try {
    make_tool(crowd);
    FAIL();
  } catch (const BadFile& bad) {
    EXPECT_NE(std::string(bad.what()).find("expected one tree of bodies that move"), std::string::npos) << bad.what();
  }
}

}  // namespace
}  // namespace zwang::god
