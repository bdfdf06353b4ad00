#include "bench/scenes/physical.h"
#include "constraints/contact.h"
#include "core/motion.h"

namespace zwang {
namespace {

constexpr double step = 0x1p-10;  // s

// Four corner contacts of A, standing on B, over the rectangle between two corners at height z.
void add_patch(Scene& scene, BodyId a, BodyId b, const Vec3& low, const Vec3& high, const std::string& label) {
  for (int corner = 0; corner < 4; ++corner) {
    const Vec3 point(corner & 1 ? high.x() : low.x(), corner & 2 ? high.y() : low.y(), low.z());
    scene.add(contact_at(scene.bodies, a, b, point, Vec3::UnitZ()), label + ", corner " + std::to_string(corner + 1));
  }
}

// z* = 0 and the multipliers that a statics book gives.
Reference at_rest(const Problem& problem, Vector lambda) {
  return {.z = Vector::Zero(problem.size()), .lambda = std::move(lambda), .method = "closed form"};
}

}  // namespace

// Boxes one on another, each a bit narrower than the one below, four corner contacts a face: z* = 0, and a quarter of
// the weight above on each corner is one valid lambda.
Instance tower(const Knobs& knobs) {
  const int boxes = static_cast<int>(knobs.at("boxes"));
  const double taper = std::ldexp(0.5, -std::ilogb(boxes) - 1);
  Scene scene;
  BodyId below = add_fixed(scene);
  for (int i = 0; i < boxes; ++i) {
    const double width = 1 - taper * i, foot = i;
    const BodyId box = scene.add(box_body({width, width, 1}, 1, {0, 0, foot + 0.5}));
    const Vec3 corner(width / 2, width / 2, 0), height(0, 0, foot);
    add_patch(scene, box, below, height - corner, height + corner,
              "box " + std::to_string(i + 1) + (i == 0 ? " on ground" : " on box " + std::to_string(i)));
    below = box;
  }
  Vector z_u;
  move_freely(scene, gravity, {}, z_u);
  Instance instance = to_instance(scene, z_u, {.dt = step, .mode = Mode::dynamic});
  Vector lambda(4 * boxes);
  for (int i = 0; i < boxes; ++i) lambda.segment<4>(4 * i).setConstant(-gravity.z() * (boxes - i) / 4);
  instance.reference = at_rest(instance.problem, std::move(lambda));
  return instance;
}

}  // namespace zwang
