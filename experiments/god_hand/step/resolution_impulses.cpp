#include <algorithm>

#include <zwang/experiments/god_hand/step/resolution.h>

// The contacts of loose objects with god objects, and what is taken away of their velocities there.

namespace zwang::god {

static constexpr double still = 1e-9;  // m/s

Resolution::Lever Resolution::lever(Loose& loose, const Vec3& point, const Vec3& normal) const {
  Lever l{&loose, normal, (point - loose.pose.position).cross(normal), {}, 0};
  const Mat3& R = loose.pose.rotation;
  l.spin = R * (R.transpose() * l.turn).cwiseQuotient(loose.inertia);
  l.ease = 1 / loose.mass + l.turn.dot(l.spin);
  return l;
}

// Loose objects nearer than `reach` to god objects, at `ahead` [s] from where they are. As many pairs are looked at as
// lie within each other's spheres.
void Resolution::meet(double reach, double ahead) {
  meetings_.clear();
  for (Loose& loose : loose_) {
    if (!loose.near) continue;
    const Pose<double> pose = retract(loose.pose, Vec<double, 6>(ahead * loose.velocity));
    for (const Object::Piece& piece : objects_[loose.object].pieces) {
      const Pose<double> at = placed(pose, piece.at);
      for (std::size_t g = 0; g < gods_.size(); ++g) {
        const collision::Shape& god = gods_[g];
        const Pose<double>& place = god_pose_[g];
        if ((place.position - at.position).norm() > reach_of(god) + reach_of(piece.shape) + reach) continue;
        const Mat3 inverse = place.rotation.transpose();
        const Pose<double> in_god{inverse * (at.position - place.position), inverse * at.rotation};
        const auto add = [&](const collision::Closest& c) {
          const double gap = c.distance - god.radius() - piece.shape.radius();
          if (gap > reach) return;
          const Vec3 n = place.rotation * c.normal;
          meetings_.push_back({&loose, gap, n, place * c.on_b + (god.radius() + gap) * n});
        };
        const collision::Closest nearest = closest(piece.shape, in_god, {.shape = &god}, 0);
        add(nearest);
        facing(piece.shape, in_god, god, nearest, reach, facing_);
        for (int k = 0; k < facing_.count; ++k) add(facing_.at[static_cast<std::size_t>(k)]);
      }
    }
  }
}

// Takes away what velocity there is toward god objects, contact by contact, each time by the impulse that just does it:
// energy only falls. A box that is stopped at its edge turns into the finger with the next one; so the outcome is tried
// out over a way of `trial`, and what comes near then is a contact as well.
void Resolution::slow(Physics& physics) {
  constexpr double trial = 2e-4;  // m
  levers_.clear();
  double ahead = 0;
  for (int round = 0; round < 10; ++round) {
    meet(round == 0 ? 2 * limits_.clearance : limits_.clearance, ahead);
    const std::size_t known = levers_.size();
    for (const Meeting& m : meetings_)
      if (const Lever l = lever(*m.loose, m.point, m.normal); approach(l) > still) levers_.push_back(l);
    if (levers_.size() == known) break;
    for (int pass = 0; pass < 50; ++pass) {
      bool done = true;
      for (const Lever& l : levers_) {
        const double impulse = approach(l) / l.ease;
        if (impulse * l.ease <= still) continue;
        done = false;
        l.loose->velocity.head<3>() += impulse / l.loose->mass * l.normal;
        l.loose->velocity.tail<3>() += impulse * l.spin;
        l.loose->moved = true;
        impulses_[l.loose->object].head<3>() += impulse * l.normal;
        impulses_[l.loose->object].tail<3>() += impulse * l.turn;
      }
      if (done) break;
    }
    double fastest = still;
    for (const Loose& loose : loose_)
      if (loose.near)
        fastest = std::max(fastest, loose.velocity.head<3>().norm() + loose.velocity.tail<3>().norm() * loose.arm);
    ahead = trial / fastest;
  }
  for (const Loose& loose : loose_)
    if (loose.moved) physics.place(loose.object, loose.pose, loose.velocity);
}

}  // namespace zwang::god
