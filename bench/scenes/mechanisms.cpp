#include <cmath>
#include <numbers>

#include <zwang/bench/scenes/physical.h>
#include <zwang/constraints/ball_joint.h>
#include <zwang/constraints/contact.h>
#include <zwang/constraints/revolute_joint.h>
#include "docs/leash.h"

namespace zwang {
namespace {

Vec<double, 6> random_velocity(double linear, double angular, Draw& draw) {
  return (Vec<double, 6>() << draw.cube(linear), draw.cube(angular)).finished();
}

}  // namespace

// Unit spheres as grocers stack oranges: square layers, each in the hollows of the one below. Neighbours at most `gap`
// apart or inside each other, of any mass within `mass_ratio`. Always feasible: everything may move away from the
// middle of the ground.
Instance pile(const Knobs& knobs) {
  const int spheres = static_cast<int>(knobs.at("spheres"));
  const double gap = knobs.at("gap"), mass_ratio = knobs.at("mass_ratio");
  Draw draw(knobs.at("seed"));
  int side = 1;
  for (int room = 1; room < spheres; room += side * side) ++side;
  Scene scene;
  const BodyId ground = add_fixed(scene);
  struct Place {
    BodyId body;
    int layer, x, y;  // x, y in half diameters
  };
  std::vector<Place> places;
  const double rise = std::sqrt(0.5);
  for (int layer = 0; static_cast<int>(places.size()) < spheres; ++layer)
    for (int k = 0; k < (side - layer) * (side - layer) && static_cast<int>(places.size()) < spheres; ++k) {
      const int x = layer + 2 * (k % (side - layer)), y = layer + 2 * (k / (side - layer));
      Body ball;
      ball.pose.position = Vec3(0.5 * x, 0.5 * y, 0.5 + rise * layer) + draw.cube(gap / 4);
      if (mass_ratio > 1) ball.mass = std::pow(mass_ratio, draw.uniform(0, 1));
      ball.inertia *= 0.1 * ball.mass;  // 2/5 m r^2
      ball.velocity = random_velocity(0.125, 1, draw);
      places.push_back({scene.add(ball), layer, x, y});
    }
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Place& a = places[i];
    const Vec3 at = scene.bodies[static_cast<std::size_t>(a.body)].pose.position;
    const std::string name = "ball " + std::to_string(i + 1) + " on ";
    if (a.layer == 0)
      scene.add(contact_at(scene.bodies, a.body, ground, at - Vec3(0, 0, 0.5), Vec3::UnitZ(), at.z() - 0.5),
                name + "ground");
    for (std::size_t j = 0; j < i; ++j) {
      const Place& b = places[j];
      const int dx = std::abs(a.x - b.x), dy = std::abs(a.y - b.y);
      const bool beside = a.layer == b.layer && dx + dy == 2 && dx * dy == 0;
      if (!beside && !(a.layer == b.layer + 1 && dx == 1 && dy == 1)) continue;
      const Vec3 apart = at - scene.bodies[static_cast<std::size_t>(b.body)].pose.position, n = apart.normalized();
      scene.add(contact_at(scene.bodies, a.body, b.body, at - 0.5 * n, n, apart.norm() - 1),
                name + "ball " + std::to_string(j + 1));
    }
  }
  return let_go(scene, knobs);
}

// Half a circle of stones, radius 4 m to 5 m, each joint with four contacts; the feet stand on the ground. Without
// friction the thrust cannot follow the circle, so the arch begins to fail: some contacts open.
Instance arch(const Knobs& knobs) {
  const int stones = static_cast<int>(knobs.at("stones"));
  const double inner = 4, outer = 5, depth = 1, slice = std::numbers::pi / stones;
  const auto ray = [](double angle) { return Vec3(std::cos(angle), 0, std::sin(angle)); };
  Scene scene;
  const BodyId ground = add_fixed(scene);
  for (int i = 0; i < stones; ++i) {
    const double middle = (i + 0.5) * slice, length = slice * (inner + outer) / 2;
    Body stone = box_body({outer - inner, depth, length}, length, (inner + outer) / 2 * ray(middle));
    stone.pose.rotation = rotation(-middle * Vec3::UnitY());  // x along the ray
    scene.add(stone);
  }
  for (int joint = 0; joint <= stones; ++joint) {
    const Vec3 r = joint == stones ? Vec3(-Vec3::UnitX()) : ray(joint * slice);
    const Vec3 forth = joint == stones ? Vec3(-Vec3::UnitZ()) : Vec3(Vec3::UnitY().cross(-r));  // to the next stone
    const BodyId behind = joint == 0 ? ground : ground + joint, ahead = joint == stones ? ground : ground + joint + 1;
    const std::string label =
        (joint == stones ? "stone " + std::to_string(stones) : "stone " + std::to_string(joint + 1)) +
        (joint == 0 || joint == stones ? " on ground" : " on stone " + std::to_string(joint));
    for (int corner = 0; corner < 4; ++corner) {
      const Vec3 point = (corner & 1 ? inner : outer) * r + (corner & 2 ? -0.5 : 0.5) * depth * Vec3::UnitY();
      const std::string name = label + (joint == stones ? ", far corner " : ", corner ") + std::to_string(corner + 1);
      if (joint == stones)
        scene.add(contact_at(scene.bodies, behind, ahead, point, -forth), name);
      else
        scene.add(contact_at(scene.bodies, ahead, behind, point, forth), name);
    }
  }
  return let_go(scene, knobs);
}

// Rods of 1/4 m, each joined to the last, the first to the ceiling; bent and tumbling at random, joints open by
// `drift`.
Instance chain(const Knobs& knobs) {
  const int links = static_cast<int>(knobs.at("links"));
  const double drift = knobs.at("drift");
  const Vec3 top(0, 0, 0.125), bottom(0, 0, -0.125);
  Draw draw(knobs.at("seed"));
  Scene scene;
  BodyId last = add_fixed(scene);
  Vec3 joint = Vec3::Zero();
  for (int i = 0; i < links; ++i) {
    Body link = box_body({0.0625, 0.0625, 0.25}, 0.5, Vec3::Zero());
    link.pose.rotation = rotation(draw.cube(0.5));
    link.pose.position = joint - link.pose.turn(top) + draw.cube(drift);
    link.velocity = random_velocity(0.25, 1, draw);
    joint = link.pose * bottom;
    const BodyId body = scene.add(link);
    scene.add(BallJoint{{body, last}, top, i == 0 ? Vec3(Vec3::Zero()) : bottom},
              "link " + std::to_string(i + 1) + (i == 0 ? " to ceiling" : " to link " + std::to_string(i)));
    last = body;
  }
  return let_go(scene, knobs);
}

// Crank, coupler and rocker in the vertical plane; all bars in their body's axes at identity rotation, so that every
// entry is dyadic when `lean` is, and the three redundant rows are consistent bit for bit.
Instance four_bar(const Knobs& knobs) {
  const double lean = knobs.at("lean");
  const std::array<Vec3, 4> corner{Vec3(0, 0, 0), Vec3(lean, 0, 1), Vec3(lean + 2, 0, 1.5), Vec3(2, 0, 0)};
  const char* name[] = {"ground to crank", "crank to coupler", "coupler to rocker", "rocker to ground"};
  Scene scene;
  const BodyId ground = add_fixed(scene);
  for (std::size_t k = 0; k < 3; ++k) scene.add(box_body({1, 0.125, 1}, 1, (corner[k] + corner[k + 1]) / 2));
  for (std::size_t k = 0; k < 4; ++k) {
    const BodyId a = ground + static_cast<int>(k), b = k == 3 ? ground : a + 1;
    const auto anchor = [&](BodyId body) -> Vec3 { return corner[k] - scene.bodies[at(body)].pose.position; };
    scene.add(RevoluteJoint{{a, b}, anchor(a), anchor(b), Vec3::UnitY(), Vec3::UnitY()}, name[k]);
  }
  return let_go(scene, knobs);
}

// Dogs on leashes of 2 m around one fixed owner; each runs, some leashes are taut.
Instance leash(const Knobs& knobs) {
  Draw draw(knobs.at("seed"));
  Scene scene;
  const BodyId owner = add_fixed(scene);
  for (int i = 0; i < knobs.at("dogs"); ++i) {
    const Vec3 way = draw.direction();
    Body dog = box_body({0.75, 0.25, 0.5}, 16, draw.uniform(1.75, 2, 3) * way);
    dog.velocity = random_velocity(4, 0, draw);
    const BodyId body = scene.add(dog);
    scene.add(Leash{.bodies = {body, owner}, .length = 2}, "dog " + std::to_string(i + 1) + " to owner");
  }
  return let_go(scene, knobs);
}

}  // namespace zwang
