#include "bench/scenes/hand.h"

#include <numbers>

#include "bench/scenes/physical.h"
#include "constraints/joint_limit.h"
#include "constraints/revolute_joint.h"
#include "constraints/universal_joint.h"

namespace zwang::hand {
namespace {

constexpr double degree = std::numbers::pi / 180, mm = 1e-3;

struct Finger {
  const char* name;
  std::array<const char*, 3> joints;
  double base[3];    // m, its joint in palm axes
  double spread;     // rad, of the straight finger about the palm's z
  double roll;       // rad, of the straight finger about its own bone: the thumb opposes the fingers
  double length[3];  // m
  Range range[4];    // rad
};

// Bone lengths: from a Leap Motion recording of a real hand (README of the shared data). Ranges: Lin, Wu & Huang
// (2000), as cited there, for the fingers and the thumb's last two joints; the two angles of the thumb's base are the
// Shadow hand's. Masses: phalanxes of 30, 17 and 13 g, a palm of 0.35 kg (same place). The palm, 84 x 96 x 28 mm, the
// places of the joints on it and the radii of the bones are our own round figures.
constexpr double a = 15 * degree;
constexpr Range mcp{0, 90 * degree}, spread{-a, a}, pip{0, 110 * degree}, dip{0, 90 * degree};
constexpr std::array<Finger, 5> fingers{{
    {"thumb",
     {"CMC", "MCP", "IP"},
     {-30 * mm, -30 * mm, -10 * mm},
     50 * degree,
     -60 * degree,
     {50.1 * mm, 34.2 * mm, 23.5 * mm},
     {{0, 70 * degree}, {-60 * degree, 60 * degree}, {0, 60 * degree}, {0, 80 * degree}}},
    {"index",
     {"MCP", "PIP", "DIP"},
     {-25 * mm, 45 * mm, 0},
     5 * degree,
     0,
     {43.1 * mm, 24.2 * mm, 17.1 * mm},
     {mcp, spread, pip, dip}},
    {"middle",
     {"MCP", "PIP", "DIP"},
     {-5 * mm, 47 * mm, 0},
     0,
     0,
     {48.3 * mm, 28.5 * mm, 18.8 * mm},
     {mcp, spread, pip, dip}},
    {"ring",
     {"MCP", "PIP", "DIP"},
     {14 * mm, 43 * mm, 0},
     -5 * degree,
     0,
     {44.8 * mm, 27.8 * mm, 18.7 * mm},
     {mcp, spread, pip, dip}},
    {"little",
     {"MCP", "PIP", "DIP"},
     {31 * mm, 35 * mm, 0},
     -10 * degree,
     0,
     {35.5 * mm, 19.6 * mm, 17.3 * mm},
     {mcp, spread, pip, dip}},
}};
constexpr double palm_mass = 0.35, phalanx_mass[3] = {0.030, 0.017, 0.013};  // kg
constexpr double palm_widths[3] = {84 * mm, 96 * mm, 28 * mm}, radius[3] = {9 * mm, 8 * mm, 7 * mm};
constexpr const char* bone[3] = {"proximal", "middle", "distal"};

const Finger& finger_of(int number) { return fingers[static_cast<std::size_t>(number)]; }

const Vec3 flexion = -Vec3::UnitX(), abduction = Vec3::UnitZ();

// The straight finger's axes at its base, in palm axes.
Mat3 base_axes(const Finger& f) { return rotation(f.spread * Vec3::UnitZ()) * rotation(f.roll * Vec3::UnitY()); }
Vec3 base_of(const Finger& f) { return Vec3(f.base[0], f.base[1], f.base[2]); }
Vec3 tip(double length) { return Vec3(0, length / 2, 0); }

}  // namespace

std::string body_name(int body) {
  if (body == 0) return "palm";
  return std::string(finger_of((body - 1) / 3).name) + " " + bone[(body - 1) % 3];
}

std::string angle_name(int angle) {
  const Finger& f = finger_of(angle / 4);
  const int k = angle % 4;
  const std::string joint = std::string(f.name) + " " + f.joints[static_cast<std::size_t>(k == 0 ? 0 : k - 1)];
  return k == 0 ? joint + " flexion" : k == 1 ? joint + " abduction" : joint;
}

Range range(int angle) { return finger_of(angle / 4).range[angle % 4]; }

Phalanx phalanx(int body) {
  const int k = (body - 1) % 3;
  return {finger_of((body - 1) / 3).length[k], phalanx_mass[k], radius[k]};
}

Poses assemble(const Pose<double>& palm, const Angles& angles) {
  Poses poses;
  poses[0] = palm;
  for (std::size_t f = 0; f < 5; ++f) {
    const double* angle = &angles[4 * f];
    Mat3 axes = palm.rotation * base_axes(fingers[f]) * rotation(angle[0] * flexion) * rotation(angle[1] * abduction);
    Vec3 joint = palm * base_of(fingers[f]);
    for (std::size_t k = 0; k < 3; ++k) {
      if (k > 0) axes = axes * rotation(angle[k + 1] * flexion);
      const Vec3 half = axes * tip(fingers[f].length[k]);
      poses[1 + 3 * f + k] = {joint + half, axes};
      joint += 2 * half;
    }
  }
  return poses;
}

BodyId add(Scene& scene, const Poses& poses, const std::string& prefix) {
  const BodyId palm =
      scene.add(box_body({palm_widths[0], palm_widths[1], palm_widths[2]}, palm_mass, poses[0].position));
  for (int b = 1; b < bodies; ++b) {
    const Phalanx p = phalanx(b);
    scene.add(box_body({2 * p.radius, p.length, 2 * p.radius}, p.mass, Vec3::Zero()));
  }
  for (std::size_t b = 0; b < poses.size(); ++b) scene.bodies[static_cast<std::size_t>(palm) + b].pose = poses[b];

  const auto limit = [&](JointLimit both, int angle) {
    const std::string label = prefix + angle_name(angle);
    both.bound = range(angle).low;
    scene.add(both, label + " lower");
    both.bound = range(angle).high;
    both.side = Side::upper;
    scene.add(both, label + " upper");
  };
  for (int number = 0; number < 5; ++number) {
    const Finger& f = finger_of(number);
    const Mat3 axes = base_axes(f);
    const BodyId first = palm + 1 + 3 * number;
    scene.add(UniversalJoint{{palm, first}, base_of(f), -tip(f.length[0]), axes * flexion, abduction},
              prefix + f.name + " " + f.joints[0]);
    limit({.bodies = {palm, first}, .axis = axes * flexion, .zero = axes * abduction, .direction = abduction},
          4 * number);
    // Seen from the phalanx, the palm's flexion axis turns back about z when the finger turns forth.
    limit({.bodies = {first, palm}, .axis = -abduction, .zero = flexion, .direction = axes * flexion}, 4 * number + 1);
    for (int k = 1; k < 3; ++k) {
      const BodyId from = first + k - 1, to = first + k;
      scene.add(RevoluteJoint{{from, to}, tip(f.length[k - 1]), -tip(f.length[k]), flexion, flexion},
                prefix + f.name + " " + f.joints[static_cast<std::size_t>(k)]);
      limit({.bodies = {from, to}, .axis = flexion, .zero = Vec3::UnitY(), .direction = Vec3::UnitY()},
            4 * number + 1 + k);
    }
  }
  return palm;
}

}  // namespace zwang::hand
