#include <array>
#include <cmath>

#include <zwang/bench/scenes/dyadic.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/constraints/contact.h>
#include <zwang/constraints/prismatic_joint.h>

// Small scenes in which friction decides. Each has a limit that a statics book gives.
namespace zwang {
namespace {

// The corners of the lower face of a box.
std::array<Vec3, 4> foot(const Body& box, const Vec3& widths) {
  std::array<Vec3, 4> corners;
  for (std::size_t k = 0; k < 4; ++k)
    corners[k] = box.pose * Vec3(widths.cwiseProduct(Vec3(k & 1 ? .5 : -.5, k & 2 ? .5 : -.5, -.5)));
  return corners;
}

// A force on the middle of body 1, the only one that is pushed.
std::vector<Vec<double, 6>> push_first(const Scene& scene, const Vec3& force, const Vec3& torque = Vec3::Zero()) {
  std::vector<Vec<double, 6>> wrench(scene.bodies.size(), Vec<double, 6>::Zero());
  wrench[1] << force, torque;
  return wrench;
}

}  // namespace

// Rests where mu >= slope; else it speeds up by g (sin - mu cos).
Instance incline(const Knobs& knobs) {
  const double angle = std::atan(knobs.at("slope"));
  const Vec3 widths(1, 1, 0.5);
  Scene scene;
  const BodyId plane = add_fixed(scene);
  Body box = box_body(widths, 1, Vec3::Zero());
  box.pose.rotation = rotation(angle * Vec3::UnitY());
  const Vec3 normal = box.pose.turn(Vec3::UnitZ());
  box.pose.position = 0.25 * normal;
  box.velocity.head<3>() = knobs.at("speed") * box.pose.turn(Vec3::UnitX());
  const BodyId body = scene.add(box);
  add_corners(scene, body, plane, foot(box, widths), normal, "box on plane");
  return let_go(scene, knobs);
}

// Slides where push > mu, tips where push > 1 / tall, rests below both.
Instance crate(const Knobs& knobs) {
  const Vec3 widths(1, 1, knobs.at("tall"));
  Scene scene;
  const BodyId ground = add_fixed(scene);
  const BodyId body = scene.add(box_body(widths, 1, {0, 0, widths.z() / 2}));
  add_corners(scene, body, ground, foot(scene.bodies[1], widths), Vec3::UnitZ(), "crate on ground");
  return let_go(scene, knobs, push_first(scene, knobs.at("push") * g_dyadic * Vec3::UnitX()));
}

// Two fingers on rails squeeze a block; it is held where 2 mu squeeze >= 1.
Instance pinch(const Knobs& knobs) {
  const double half = 0.25;  // m, of the block
  Scene scene;
  const BodyId ground = add_fixed(scene);
  const BodyId block = scene.add(box_body(Vec3::Constant(2 * half), 1, Vec3::Zero()));
  std::vector<Vec<double, 6>> wrench(2, Vec<double, 6>::Zero());
  for (const double side : {-1., 1.}) {
    const std::string name = side < 0 ? "left finger" : "right finger";
    const Vec3 place(side * (half + 0.125), 0, 0);
    const BodyId finger = scene.add(box_body(Vec3::Constant(0.25), 0.125, place));
    scene.add(PrismaticJoint{.bodies = {finger, ground}, .anchor_b = place}, name + " on rail");
    std::array<Vec3, 4> pad;
    for (std::size_t k = 0; k < 4; ++k) pad[k] = Vec3(side * half, k & 1 ? .125 : -.125, k & 2 ? .125 : -.125);
    add_corners(scene, finger, block, pad, side * Vec3::UnitX(), name + " on block");
    wrench.emplace_back(Vec<double, 6>::Zero())[0] = -side * knobs.at("squeeze") * g_dyadic;
  }
  return let_go(scene, knobs, wrench);
}

// A ladder of 4 m against a wall, two rails; it rests where slope >= (1 - mu^2) / (2 mu).
Instance ladder(const Knobs& knobs) {
  const double length = 4, angle = std::atan(knobs.at("slope"));
  const Vec3 bottom(length * std::cos(angle), 0, 0), top(0, 0, length * std::sin(angle));
  Scene scene;
  const BodyId ground = add_fixed(scene);
  Body rails = box_body({0.0625, 0.5, length}, 8, (bottom + top) / 2);
  rails.pose.rotation = rotation(-std::atan2(1, knobs.at("slope")) * Vec3::UnitY());
  const BodyId body = scene.add(rails);
  for (const double side : {-0.25, 0.25}) {
    const std::string rail = side < 0 ? ", right rail" : ", left rail";
    const Vec3 across = side * Vec3::UnitY();
    scene.add(contact_at(scene.bodies, body, ground, bottom + across, Vec3::UnitZ()), "ladder on ground" + rail);
    scene.add(contact_at(scene.bodies, body, ground, top + across, Vec3::UnitX()), "ladder on wall" + rail);
  }
  return let_go(scene, knobs);
}

// A ball thrown along the ground: it slides until it rolls, at 5/7 of its speed where it did not spin.
Instance ball(const Knobs& knobs) {
  Scene scene;
  const BodyId ground = add_fixed(scene);
  Body sphere;
  sphere.pose.position = {0, 0, 0.5};
  sphere.inertia *= 0.1;  // 2/5 m r^2
  sphere.velocity << knobs.at("speed"), 0, 0, 0, knobs.at("spin"), 0;
  const BodyId body = scene.add(sphere);
  scene.add(contact_at(scene.bodies, body, ground, Vec3::Zero(), Vec3::UnitZ()), "ball on ground");
  return let_go(scene, knobs);
}

// A box set down on a running belt: it is carried along with mu g until it has the belt's speed.
Instance belt(const Knobs& knobs) {
  const Vec3 widths(1, 1, 0.5);
  Scene scene;
  const BodyId ground = add_fixed(scene);
  Body box = box_body(widths, 1, {0, 0, 0.25});
  box.velocity.x() = knobs.at("carried");
  const BodyId body = scene.add(box);
  add_corners(scene, body, ground, foot(box, widths), Vec3::UnitZ(), "box on belt");
  for (Contact& contact : scene.list_of<Contact>().all) contact.surface = knobs.at("speed") * Vec3::UnitX();
  return let_go(scene, knobs);
}

// A peg in a slot, loaded beside its axis: it leans on both walls, `apart` above each other, with load offset / apart
// each. It jams where 2 mu load offset / apart >= 1 + load.
Instance peg(const Knobs& knobs) {
  const double load = knobs.at("load"), offset = knobs.at("offset"), apart = knobs.at("apart"), half = 0.125;
  Scene scene;
  const BodyId slot = add_fixed(scene);
  const BodyId body = scene.add(box_body({2 * half, 2 * half, 1}, 1, Vec3::Zero()));
  for (const double side : {-1., 1.})
    for (const double across : {-half, half})
      scene.add(contact_at(scene.bodies, body, slot, {side * half, across, side * apart / 2}, -side * Vec3::UnitX()),
                std::string(side < 0 ? "peg on left wall" : "peg on right wall") + (across < 0 ? ", near" : ", far"));
  return let_go(scene, knobs,
                push_first(scene, -load * g_dyadic * Vec3::UnitZ(), load * offset * g_dyadic * Vec3::UnitY()));
}

}  // namespace zwang
