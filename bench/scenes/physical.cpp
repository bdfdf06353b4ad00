#include <zwang/bench/scenes/physical.h>

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

Instance to_instance(Scene& scene, const Vector& z_u, const AssembleOptions& options) {
  Instance instance;
  Assembler assembler;
  assembler.assemble(scene, z_u, options, instance.problem);
  instance.origin = assembler.origin(scene, instance.problem);
  return instance;
}

}  // namespace zwang
