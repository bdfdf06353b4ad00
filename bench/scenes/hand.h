#pragma once

#include <array>
#include <string>

#include <zwang/core/model/scene.h>

namespace zwang::hand {

// The god hand of section 5 of the paper: a palm and five fingers of three phalanxes, 16 bodies, 96 unknowns. Universal
// joints at the palm (4 rows each, 20 rows), hinges within the fingers (5 rows each, 50 rows), limits on the 20 angles.
//
// Palm axes: y toward the fingers, z out of the back of the hand; x toward the little finger of a right hand, toward
// the thumb of a left one; origin at the centre of mass. Phalanx axes: y along the bone, z out of its back, origin at
// the bone's middle. Positive flexion curls toward the palm (about -x), positive abduction turns about +z.
inline constexpr int bodies = 16, angles = 20;

using Poses = std::array<Pose<double>, bodies>;  // palm, then proximal, middle, distal of thumb .. little finger
using Angles = std::array<double, angles>;       // rad; per finger: base flexion, base abduction, second, third joint

struct Range {
  double low, high;  // rad
};

struct Phalanx {
  double length, mass, radius;  // m, kg, m
};

struct Finger {
  Vec3 base = Vec3::Zero();  // m, its joint in palm axes
  double spread = 0;         // rad, of the straight finger about the palm's z
  double roll = 0;           // rad, of the straight finger about its own bone: the thumb opposes the fingers
  std::array<Phalanx, 3> bone = {};
  std::array<Range, 4> range = {};  // of its angles
};

// The measures of one hand.
struct Model {
  Vec3 palm_widths = Vec3::Zero();  // m
  double palm_mass = 0;             // kg
  std::array<Finger, 5> fingers = {};
  bool left = false;  // positive abduction turns about -z

  Phalanx phalanx(int body) const;  // of bodies 1..15
  Range range(int angle) const;
};

const Model& standard();
// The other hand: everything reflected in the palm's x.
Model mirrored(const Model& model);

std::string body_name(int body);    // "palm", "index distal"
std::string angle_name(int angle);  // "index MCP flexion", "index PIP", "thumb IP"
inline Range range(int angle) { return standard().range(angle); }
inline Phalanx phalanx(int body) { return standard().phalanx(body); }

// Forward kinematics: every joint closed, limits ignored.
Poses forward_kinematics(const Pose<double>& palm, const Angles& angles, const Model& model = standard());

// Adds the bodies at these poses, the 15 joints and both sides of the 20 limits, written from `reach` [rad] before they
// are met on (0: once violated). Labels start with `prefix` ("left "). Returns the palm's id; the others follow in the
// order of Poses.
BodyId add(Scene& scene, const Poses& poses, const std::string& prefix = "", const Model& model = standard(),
           double reach = 0);

}  // namespace zwang::hand
