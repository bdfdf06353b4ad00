#include <zwang/bench/scenes/hand.h>

#include <numbers>

#include <zwang/bench/scenes/physical.h>
#include <zwang/constraints/joint_limit.h>
#include <zwang/constraints/revolute_joint.h>
#include <zwang/constraints/universal_joint.h>

namespace zwang::hand {
namespace {

constexpr double degree = std::numbers::pi / 180, mm = 1e-3;

struct Name {
  const char* finger;
  std::array<const char*, 3> joints;
};
constexpr std::array<Name, 5> names{{{"thumb", {"CMC", "MCP", "IP"}},
                                     {"index", {"MCP", "PIP", "DIP"}},
                                     {"middle", {"MCP", "PIP", "DIP"}},
                                     {"ring", {"MCP", "PIP", "DIP"}},
                                     {"little", {"MCP", "PIP", "DIP"}}}};
constexpr const char* bone_name[3] = {"proximal", "middle", "distal"};

// Bone lengths: from a Leap Motion recording of a real hand (README of the shared data). Ranges: Lin, Wu & Huang
// (2000), as cited there, for the fingers and the thumb's last two joints; the two angles of the thumb's base are the
// Shadow hand's. Masses: phalanxes of 30, 17 and 13 g, a palm of 0.35 kg (same place). The palm, 84 x 96 x 28 mm, the
// places of the joints on it and the radii of the bones are our own round figures.
Model make_standard() {
  constexpr double a = 15 * degree;
  constexpr Range mcp{0, 90 * degree}, spread{-a, a}, pip{0, 110 * degree}, dip{0, 90 * degree};
  const auto bones = [](double first, double second, double third) {
    return std::array<Phalanx, 3>{
        {{first * mm, 0.030, 9 * mm}, {second * mm, 0.017, 8 * mm}, {third * mm, 0.013, 7 * mm}}};
  };
  return {.palm_widths = Vec3(84, 96, 28) * mm,
          .palm_mass = 0.35,
          .fingers = {{{Vec3(-30, -30, -10) * mm,
                        50 * degree,
                        -60 * degree,
                        bones(50.1, 34.2, 23.5),
                        {{{0, 70 * degree}, {-60 * degree, 60 * degree}, {0, 60 * degree}, {0, 80 * degree}}}},
                       {Vec3(-25, 45, 0) * mm, 5 * degree, 0, bones(43.1, 24.2, 17.1), {{mcp, spread, pip, dip}}},
                       {Vec3(-5, 47, 0) * mm, 0, 0, bones(48.3, 28.5, 18.8), {{mcp, spread, pip, dip}}},
                       {Vec3(14, 43, 0) * mm, -5 * degree, 0, bones(44.8, 27.8, 18.7), {{mcp, spread, pip, dip}}},
                       {Vec3(31, 35, 0) * mm, -10 * degree, 0, bones(35.5, 19.6, 17.3), {{mcp, spread, pip, dip}}}}}};
}

const Vec3 flexion = -Vec3::UnitX();
Vec3 abduction(const Model& model) { return (model.left ? -1.0 : 1.0) * Vec3::UnitZ(); }

// The straight finger's axes at its base, in palm axes.
Mat3 base_axes(const Finger& f) { return rotation(f.spread * Vec3::UnitZ()) * rotation(f.roll * Vec3::UnitY()); }
Vec3 tip(const Phalanx& bone) { return Vec3(0, bone.length / 2, 0); }

}  // namespace

const Model& standard() {
  static const Model model = make_standard();
  return model;
}

Model mirrored(const Model& model) {
  Model other = model;
  other.left = !model.left;
  for (Finger& f : other.fingers) {
    f.base.x() = -f.base.x();
    f.spread = -f.spread;
    f.roll = -f.roll;
  }
  return other;
}

Phalanx Model::phalanx(int body) const { return fingers[at((body - 1) / 3)].bone[at((body - 1) % 3)]; }

Range Model::range(int angle) const { return fingers[at(angle / 4)].range[at(angle % 4)]; }

std::string body_name(int body) {
  if (body == 0) return "palm";
  return std::string(names[at((body - 1) / 3)].finger) + " " + bone_name[(body - 1) % 3];
}

std::string angle_name(int angle) {
  const Name& n = names[at(angle / 4)];
  const int k = angle % 4;
  const std::string joint = std::string(n.finger) + " " + n.joints[at(k == 0 ? 0 : k - 1)];
  return k == 0 ? joint + " flexion" : k == 1 ? joint + " abduction" : joint;
}

Poses forward_kinematics(const Pose<double>& palm, const Angles& angles, const Model& model) {
  Poses poses;
  poses[0] = palm;
  for (std::size_t f = 0; f < 5; ++f) {
    const Finger& finger = model.fingers[f];
    const double* angle = &angles[4 * f];
    Mat3 axes =
        palm.rotation * base_axes(finger) * rotation(angle[0] * flexion) * rotation(angle[1] * abduction(model));
    Vec3 joint = palm * finger.base;
    for (std::size_t k = 0; k < 3; ++k) {
      if (k > 0) axes = axes * rotation(angle[k + 1] * flexion);
      const Vec3 half = axes * tip(finger.bone[k]);
      poses[1 + 3 * f + k] = {joint + half, axes};
      joint += 2 * half;
    }
  }
  return poses;
}

BodyId add(Scene& scene, const Poses& poses, const std::string& prefix, const Model& model, double reach) {
  const BodyId palm = scene.add(box_body(model.palm_widths, model.palm_mass, poses[0].position));
  for (int b = 1; b < bodies; ++b) {
    const Phalanx p = model.phalanx(b);
    scene.add(box_body({2 * p.radius, p.length, 2 * p.radius}, p.mass, Vec3::Zero()));
  }
  for (std::size_t b = 0; b < poses.size(); ++b) scene.bodies[at(palm) + b].pose = poses[b];

  const auto limit = [&](JointLimit both, int angle) {
    const std::string label = prefix + angle_name(angle);
    both.reach = reach;
    both.bound = model.range(angle).low;
    scene.add(both, label + " lower");
    both.bound = model.range(angle).high;
    both.side = Side::upper;
    scene.add(both, label + " upper");
  };
  for (int number = 0; number < 5; ++number) {
    const Finger& f = model.fingers[at(number)];
    const Name& name = names[at(number)];
    const Mat3 axes = base_axes(f);
    const Vec3 sideways = abduction(model);
    const BodyId first = palm + 1 + 3 * number;
    scene.add(UniversalJoint{{palm, first}, f.base, -tip(f.bone[0]), axes * flexion, sideways},
              prefix + name.finger + " " + name.joints[0]);
    limit({.bodies = {palm, first}, .axis = axes * flexion, .zero = axes * sideways, .direction = sideways},
          4 * number);
    // Seen from the phalanx, the palm's flexion axis turns about -z when the finger turns about +z.
    limit({.bodies = {first, palm}, .axis = -sideways, .zero = flexion, .direction = axes * flexion}, 4 * number + 1);
    for (int k = 1; k < 3; ++k) {
      const BodyId from = first + k - 1, to = first + k;
      const auto bone = at(k);
      scene.add(RevoluteJoint{{from, to}, tip(f.bone[bone - 1]), -tip(f.bone[bone]), flexion, flexion},
                prefix + name.finger + " " + name.joints[bone]);
      limit({.bodies = {from, to}, .axis = flexion, .zero = Vec3::UnitY(), .direction = Vec3::UnitY()},
            4 * number + 1 + k);
    }
  }
  return palm;
}

}  // namespace zwang::hand
