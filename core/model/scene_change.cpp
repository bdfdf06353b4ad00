#include <zwang/core/model/scene_change.h>

#include <Eigen/Cholesky>

#include <zwang/core/model/motion.h>

namespace zwang {

Vector unconstrained(const SceneStep& step) {
  Vector z_u;
  if (step.options.mode == Mode::dynamic)
    move_freely(step.scene, step.gravity, step.wrench, z_u);
  else
    couple_to_targets(step.scene, step.target, step.k_s, z_u);
  return z_u;
}

// d (R I R') = [w]x W + W [w]x' + W dm/m.
void change_masses(const SceneStep& step, const SceneChange& change, Problem& derivative) {
  double* value = derivative.M.valuePtr();
  for (std::size_t b = 0; b < step.scene.bodies.size(); ++b) {
    const Body& body = step.scene.bodies[b];
    if (body.motion != Motion::free) continue;
    const Mat3 world = body.pose.rotation * body.inertia * body.pose.rotation.transpose();
    const Mat3 turning = skew<double>(change.bodies[b].pose.tail<3>()) * world;
    const double mass = change.bodies[b].mass;
    value = write_body_mass(mass, turning + turning.transpose() + mass / body.mass * world, value);
  }
  std::fill(value, derivative.M.valuePtr() + derivative.M.nonZeros(), 0.);  // soft rows
}

// Of z_u = [g + f/m; R I^-1 (R' tau - w x I w)], w = R' omega, in the body's axes; by twist_between's own derivative of
// targets.
void change_free_motion(const SceneStep& step, const SceneChange& change, Problem& derivative) {
  derivative.z_u.setZero();
  Index column = 0;
  for (std::size_t b = 0; b < step.scene.bodies.size(); ++b) {
    const Body& body = step.scene.bodies[b];
    if (body.motion != Motion::free) continue;
    auto out = derivative.z_u.segment<6>(column);
    column += 6;
    const SceneChange::OfBody& d = change.bodies[b];
    const Mat3& R = body.pose.rotation;
    if (step.options.mode == Mode::quasi_static) {
      const Pose<moving::Number> from = moving::pose(body.pose, d.pose);
      const Pose<moving::Number> to{step.target[b].position.cast<moving::Number>(),
                                    step.target[b].rotation.cast<moving::Number>()};
      const Vec<moving::Number, 6> twist = twist_between(from, to);
      for (int k = 0; k < 6; ++k) out[k] = step.k_s * twist[k].derivatives()[0];
      continue;
    }
    const Vec3 turn = d.pose.tail<3>(), w = R.transpose() * body.velocity.tail<3>();
    const Vec3 dw = R.transpose() * (d.velocity.tail<3>() - turn.cross(Vec3(body.velocity.tail<3>())));
    const double share = d.mass / body.mass;
    Vec3 torque = -w.cross(body.inertia * w);
    Vec3 dtorque = share * torque - dw.cross(body.inertia * w) - w.cross(body.inertia * dw);
    if (!step.wrench.empty()) {
      const Vec3 outer = step.wrench[b].tail<3>();
      torque += R.transpose() * outer;
      dtorque -= R.transpose() * turn.cross(outer);
      out.head<3>() = -share / body.mass * step.wrench[b].head<3>();
    }
    const auto inertia = body.inertia.llt();
    const Vec3 spin = inertia.solve(torque), dspin = inertia.solve(dtorque) - share * spin;
    out.tail<3>() = turn.cross(R * spin) + R * dspin;
  }
}

}  // namespace zwang
