#include <zwang/core/model/motion.h>

#include <stdexcept>

namespace zwang {
namespace {

void require_one_per_body(const char* what, std::size_t count, const Scene& scene) {
  if (count != scene.bodies.size())
    throw std::invalid_argument("scene '" + scene.name + "': " + std::to_string(count) + " " + what + " for " +
                                std::to_string(scene.bodies.size()) + " bodies");
}

// Calls visit(body number, its first column) for every free body.
template <class Visit>
Index for_each_free(const Scene& scene, const Visit& visit) {
  Index column = 0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (scene.bodies[b].motion == Motion::free) visit(b, column), column += 6;
  return column;
}

Index free_columns(const Scene& scene) {
  return for_each_free(scene, [](std::size_t, Index) {});
}

}  // namespace

void couple_to_targets(const Scene& scene, PoseSpan target, double k_s, Vector& z_u) {
  require_one_per_body("target poses", target.size(), scene);
  z_u.resize(free_columns(scene));
  for_each_free(scene, [&](std::size_t b, Index column) {
    z_u.segment<6>(column) = k_s * twist_between(scene.bodies[b].pose, target[b]);
  });
}

void move_freely(const Scene& scene, const Vec3& gravity, std::span<const Vec<double, 6>> wrench, Vector& z_u) {
  if (!wrench.empty()) require_one_per_body("wrenches", wrench.size(), scene);
  z_u.resize(free_columns(scene));
  for_each_free(scene, [&](std::size_t b, Index column) {
    const Body& body = scene.bodies[b];
    const Mat3& R = body.pose.rotation;
    const Vec3 w = R.transpose() * body.velocity.tail<3>();
    Vec3 force = Vec3::Zero(), torque = -w.cross(body.inertia * w);
    if (!wrench.empty()) {
      force = wrench[b].head<3>();
      torque += R.transpose() * wrench[b].tail<3>();
    }
    const Vec3 spin = body.inertia.llt().solve(torque);
    z_u.segment<3>(column) = gravity + force / body.mass;
    z_u.segment<3>(column + 3) = R * spin;
  });
}

void integrate(Scene& scene, const Vector& z, double dt, Mode mode, std::span<const double> toc) {
  if (toc.size() != 1) require_one_per_body("times of contact", toc.size(), scene);
  if (z.size() < free_columns(scene))
    throw std::invalid_argument("scene '" + scene.name + "': z has " + std::to_string(z.size()) +
                                " entries, the free bodies need " + std::to_string(free_columns(scene)));
  Index column = 0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    Body& body = scene.bodies[b];
    if (body.motion == Motion::fixed) continue;
    Vec<double, 6> acceleration = body.prescribed;
    if (body.motion == Motion::free) acceleration = z.segment<6>(column), column += 6;
    Vec<double, 6> velocity = dt * acceleration;
    if (mode == Mode::dynamic) velocity = body.velocity += velocity;
    body.pose = retract<double>(body.pose, toc[toc.size() == 1 ? 0 : b] * dt * velocity);
  }
}

}  // namespace zwang
