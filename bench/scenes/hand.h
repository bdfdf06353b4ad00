#pragma once

#include <array>
#include <string>

#include "core/scene.h"

namespace zwang::hand {

// The god hand of section 5 of the paper: a palm and five fingers of three phalanxes, 16 bodies, 96 unknowns. Universal
// joints at the palm (4 rows each, 20 rows), hinges within the fingers (5 rows each, 50 rows), limits on the 20 angles.
//
// A right hand. Palm axes: y toward the fingers, z out of the back of the hand, x toward the little finger; origin at
// the centre of mass. Phalanx axes: y along the bone, z out of its back, origin at the bone's middle. Positive flexion
// curls toward the palm (about -x), positive abduction turns about +z.
inline constexpr int bodies = 16, angles = 20;

using Poses = std::array<Pose<double>, bodies>;  // palm, then proximal, middle, distal of thumb .. little finger
using Angles = std::array<double, angles>;       // rad; per finger: base flexion, base abduction, second, third joint

struct Range {
  double low, high;  // rad
};

struct Phalanx {
  double length, mass, radius;  // m, kg, m
};

std::string body_name(int body);    // "palm", "index distal"
std::string angle_name(int angle);  // "index MCP flexion", "index PIP", "thumb IP"
Range range(int angle);
Phalanx phalanx(int body);  // of bodies 1..15

// Forward kinematics: every joint closed, limits ignored.
Poses assemble(const Pose<double>& palm, const Angles& angles);

// Adds the bodies at these poses, the 15 joints and both sides of the 20 limits. Labels start with `prefix`
// ("left "). Returns the palm's id; the others follow in the order of Poses.
BodyId add(Scene& scene, const Poses& poses, const std::string& prefix = "");

}  // namespace zwang::hand
