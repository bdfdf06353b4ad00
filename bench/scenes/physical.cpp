#include <zwang/bench/scenes/physical.h>

#include <zwang/bench/scenes/friction/friction.h>
#include <zwang/constraints/contact.h>

namespace zwang {

Body box_body(const Vec3& widths, double mass, const Vec3& position) {
  Body body;
  body.pose.position = position;
  body.mass = mass;
  const Vec3 square = widths.cwiseAbs2();
  body.inertia = (mass / 12 * (Vec3::Constant(square.sum()) - square)).asDiagonal();
  return body;
}

BodyId add_fixed(Scene& scene, const Vec3& position) {
  Body body;
  body.pose.position = position;
  body.motion = Motion::fixed;
  return scene.add(body);
}

void add_corners(Scene& scene, BodyId a, BodyId b, std::span<const Vec3> corners, const Vec3& normal,
                 const std::string& label) {
  for (std::size_t k = 0; k < corners.size(); ++k)
    scene.add(contact_at(scene.bodies, a, b, corners[k], normal), label + ", corner " + std::to_string(k + 1));
}

Instance to_instance(Scene& scene, const Vector& z_u, const AssembleOptions& options) {
  Instance instance;
  Assembler assembler;
  assembler.assemble(scene, z_u, options, instance.problem);
  instance.origin = assembler.origin(scene, instance.problem);
  return instance;
}

Instance to_instance(SceneStep step) {
  Instance instance = to_instance(step.scene, unconstrained(step), step.options);
  instance.step = std::make_shared<const SceneStep>(std::move(step));
  return instance;
}

Instance let_go(Scene& scene, const Knobs& knobs, std::span<const Vec<double, 6>> wrench) {
  rub(scene, friction_of(knobs));
  return to_instance({.scene = std::move(scene),
                      .options = {.dt = scene_dt, .mode = Mode::dynamic},
                      .gravity = gravity,
                      .wrench = {wrench.begin(), wrench.end()}});
}

}  // namespace zwang
