#include <Eigen/QR>
#include <algorithm>

#include <zwang/bench/scenes/families.h>
#include <zwang/bench/scenes/friction/friction.h>
#include <zwang/bench/scenes/hand.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/constraints/contact.h>
#include <zwang/constraints/weld.h>
#include <zwang/core/model/motion.h>

namespace zwang {
namespace {

constexpr double frame_dt = 0x1p-7;  // s

// A hand pressed into a wall: its pose, its target, and the points at which its pads touch.
struct PressedHand {
  hand::Poses god, target;
  struct Touch {
    int body;
    Vec3 point, normal;  // m; unit, out of the wall
    double gap;          // m
  };
  std::vector<Touch> touches;
};

template <class T>
void shuffle(std::vector<T>& items, Draw& draw) {
  for (std::size_t k = items.size(); k > 1; --k) std::swap(items[k - 1], items[at(draw.below(static_cast<int>(k)))]);
}

// Angles within the middle of their ranges, but `violated` of them 2 to 4 degrees beyond a bound.
hand::Angles draw_angles(int violated, Draw& draw) {
  hand::Angles angles;
  std::vector<int> order = numbers_from(0, hand::angles);
  shuffle(order, draw);
  for (int k = 0; k < hand::angles; ++k) {
    const int angle = order[at(k)];
    const auto [low, high] = hand::range(angle);
    const double excess = draw.uniform(0x1p-5, 0x1p-4);
    double value = draw.uniform(low + 0.2 * (high - low), high - 0.4 * (high - low));
    if (k < violated) value = draw.below(2) ? high + excess : low - excess;
    angles[at(angle)] = value;
  }
  return angles;
}

// Moves every phalanx by up to `distance` [m] and turns it by what moves its ends as far.
void disturb(hand::Poses& poses, double distance, Draw& draw) {
  for (int b = 1; b < hand::bodies; ++b) {
    const Vec3 way = draw.cube(distance), turn = draw.cube(distance / (hand::phalanx(b).length / 2));
    Pose<double>& pose = poses[at(b)];
    pose = retract(pose, (Vec<double, 6>() << way, turn).finished());
  }
}

// The smallest motion that satisfies the joints and the violated limits.
Vector free_motion(const hand::Poses& poses) {
  Scene scene;
  hand::add(scene, poses);
  Problem problem;
  Assembler{}.assemble(scene, Vector::Zero(6 * hand::bodies), {.dt = frame_dt}, problem);
  return Matrix(problem.J).completeOrthogonalDecomposition().solve(problem.c);
}

// Several contacts per phalanx, on one flat face under its pad: four or more rows of rank three, with different gaps,
// so that no k with J k = c exists for the paper's form. By construction one motion satisfies all rows strictly:
// gaps are drawn around that motion. Otherwise gaps are drawn at random, which may ask for too much.
PressedHand press(const Vec3& place, const Knobs& knobs, bool feasible, Draw& draw) {
  PressedHand out;
  const int contacts = static_cast<int>(knobs.at("contacts"));
  const double drift = knobs.at("drift");
  hand::Angles angles = draw_angles(static_cast<int>(knobs.at("limits")), draw);
  const Pose<double> palm{place, rotation(draw.cube(0.5))};
  out.god = hand::forward_kinematics(palm, angles);
  disturb(out.god, drift, draw);

  // The target: the palm 10 to 20 mm toward the wall, the fingers curled further, each bone off by up to 2 mm.
  for (double& angle : angles) angle += draw.uniform(0, 0.25);
  const Vec3 into_wall = palm.turn(Vec3(0, 0, -draw.uniform(0.01, 0.02)));
  out.target = hand::forward_kinematics(
      {place + into_wall + draw.cube(0.005), palm.rotation * rotation(draw.cube(0.1))}, angles);
  disturb(out.target, 0.002, draw);

  std::vector<int> order = numbers_from(1, hand::bodies - 1);
  shuffle(order, draw);
  const int touched = std::min(hand::bodies - 1, (contacts + 3) / 4);
  std::array<Vec3, hand::bodies> face;  // normals in phalanx axes, out of the wall
  for (Vec3& n : face) n = rotation(draw.uniform(-0.4, 0.4) * Vec3::UnitY()) * Vec3::UnitZ();
  const Vector z_free = feasible ? free_motion(out.god) : Vector();
  for (int k = 0; k < contacts; ++k) {
    const int b = order[at(k % touched)];
    const auto s = at(b);
    const hand::Phalanx p = hand::phalanx(b);
    const Vec3 across = Vec3::UnitY().cross(face[s]);
    const double sideways = draw.uniform(-0.5, 0.5), along = draw.uniform(-0.5, 0.5);
    const Vec3 local = along * p.length * Vec3::UnitY() + sideways * p.radius * across - p.radius * face[s];
    const Vec3 lever = out.god[s].turn(local), normal = out.god[s].turn(face[s]);
    double gap = draw.uniform(-0x1p-10, 0x1p-10);
    if (feasible) {
      const Vec3 moved = z_free.segment<3>(6 * b) + z_free.segment<3>(6 * b + 3).cross(lever);
      gap = draw.uniform(0x1p-20, 0x1p-10) - frame_dt * frame_dt * normal.dot(moved);
    }
    out.touches.push_back({b, out.god[s].position + lever, normal, gap});
  }
  return out;
}

// Welds the index finger's second joint at its present angle.
void lock_index_finger(Scene& scene, BodyId palm, const std::string& prefix) {
  const BodyId proximal = palm + 4, middle = palm + 5;
  const Pose<double>&a = scene.bodies[at(proximal)].pose, &b = scene.bodies[at(middle)].pose;
  scene.add(Weld{.bodies = {proximal, middle},
                 .anchor_a = a.rotation.transpose() * (b.position - a.position),
                 .relative = a.rotation.transpose() * b.rotation},
            prefix + "index PIP locked");
}

}  // namespace

SceneStep pose_hands(const Knobs& knobs) {
  const int count = knobs.contains("hands") ? static_cast<int>(knobs.at("hands")) : 1;
  const bool feasible = !knobs.contains("feasible") || knobs.at("feasible") > 0;
  Draw draw(knobs.at("seed"));
  SceneStep posed{.options = {.dt = frame_dt}, .k_s = reaching_stiffness(frame_dt)};
  Scene& scene = posed.scene;
  std::vector<Pose<double>>& target = posed.target;
  target.resize(1);
  const BodyId wall = add_fixed(scene);
  for (int h = 0; h < count; ++h) {
    const PressedHand pressed = press(Vec3(0.5 * h, 0, 0), knobs, feasible, draw);
    const std::string prefix = count > 1 ? "hand " + std::to_string(h + 1) + " " : "";
    const BodyId palm = hand::add(scene, pressed.god, prefix);
    target.insert(target.end(), pressed.target.begin(), pressed.target.end());
    if (knobs.contains("locked") && knobs.at("locked") > 0) lock_index_finger(scene, palm, prefix);
    std::array<int, hand::bodies> number{};
    for (const PressedHand::Touch& t : pressed.touches)
      scene.add(contact_at(scene.bodies, palm + t.body, wall, t.point, t.normal, t.gap),
                prefix + hand::body_name(t.body) + " " + std::to_string(++number[at(t.body)]) + " on wall");
  }
  rub(scene, friction_of(knobs));
  return posed;
}

SceneStep drifting_hand(double contacts) {
  return pose_hands({{"contacts", contacts}, {"limits", 5}, {"drift", 0x1p-13}, {"seed", 1}});
}

Instance hands(const Knobs& knobs) { return to_instance(pose_hands(knobs)); }

// 70 joint rows, 20 limits and 30 contacts a hand, on 96 unknowns. A family of the atlas: its numbers are rounded to
// grids far coarser than rounding, so that every compiler and processor makes the same problem, and far finer than the
// room that the contacts leave (2^-20 m over the square of the step, 2^-6 m/s^2).
Instance crowded_hands(const Knobs& knobs) {
  Instance instance = hands({{"hands", knobs.at("hands")},
                             {"contacts", 30},
                             {"limits", hand::angles},
                             {"drift", 0x1p-13},
                             {"mu", friction_of(knobs)},
                             {"seed", knobs.at("seed")}});
  const auto round_to = [](double grid, auto&& numbers) { numbers = (numbers / grid).round() * grid; };
  instance.step.reset();
  Problem& p = instance.problem;
  round_to(0x1p-48, p.M.coeffs());
  round_to(0x1p-32, p.J.coeffs());
  round_to(0x1p-12, p.z_u.array());
  round_to(0x1p-12, p.c.array());
  return instance;
}

}  // namespace zwang
