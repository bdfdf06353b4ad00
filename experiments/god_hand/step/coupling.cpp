#include <zwang/experiments/god_hand/step/coupling.h>

#include <algorithm>
#include <cmath>

#include <zwang/experiments/god_hand/step/following.h>
#include <zwang/experiments/god_hand/step/lap.h>

namespace zwang::god {
namespace {

constexpr double tau = coupling_time, fade = 0.5;  // s
constexpr double share = 1.5;                      // of the hand's speed
constexpr double rests = 0.05, patience = 0.005;   // s: without news so long a hand rests; so long it never does

Vec3 velocity_at(const Vec<double, 6>& twist, const Vec3& lever) {
  return twist.head<3>() + twist.tail<3>().cross(lever);
}

Mat3 inverse_inertia(const Object& object, const Mat3& rotation) {
  return rotation * object.inertia.inverse() * rotation.transpose();
}

}  // namespace

Coupling::Coupling(const Surroundings& surroundings, const Options& options, std::span<const Cluster> clusters)
    : surroundings_(&surroundings), options_(options) {
  memory_.hand_speed.assign(clusters.size(), 0);
  memory_.since = memory_.between = memory_.hand_speed;
  for (const Cluster& c : clusters) memory_.target_velocity.emplace_back(c.size(), Vec<double, 6>::Zero());
  memory_.wrench.assign(surroundings.objects.size(), Vec<double, 6>::Zero());
  memory_.part.assign(clusters.size(), memory_.wrench);
  change_ = other_ = others_ = memory_.wrench;
  if (options.mu > 0)
    for (const Cluster& c : clusters) grasps_.emplace_back(c.objects().scene, surroundings, options);
}

// Targets that are the same to the bit are no news: a tracker is slower than the loop, or missed a step. Taken for
// rest, they would shake the damper of a grip by the whole speed each time, and what it holds would slip.
void Coupling::aim(std::size_t cluster, PoseSpan last, PoseSpan now) {
  std::vector<Vec<double, 6>>& velocity = memory_.target_velocity[cluster];
  double &since = memory_.since[cluster], &between = memory_.between[cluster];
  since += options_.dt;
  const bool news = !std::ranges::equal(last, now, is_same);
  if (news) {
    between = since <= rests ? since : options_.dt;
    since = 0;
    for (std::size_t b = 0; b < now.size(); ++b) velocity[b] = twist_between(last[b], now[b]) / between;
  }
  double fastest = 0;
  for (const Vec<double, 6>& v : velocity) fastest = std::max(fastest, v.head<3>().norm());
  if (fastest > options_.fastest || (!news && since > std::max(2 * between, patience))) {
    for (Vec<double, 6>& v : velocity) v.setZero();
    fastest = 0;
  }
  memory_.hand_speed[cluster] = std::max(fastest, memory_.hand_speed[cluster] * std::exp(-options_.dt / fade));
}

void Coupling::observe(std::size_t object, const Vec<double, 6>& before, const Vec<double, 6>& after,
                       const Mat3& rotation) {
  const Object& o = surroundings_->objects[object];
  const Vec<double, 6> gained = (after - before) / options_.dt;
  other_[object] << o.mass * (gained.head<3>() - surroundings_->gravity),
      rotation * o.inertia * rotation.transpose() * gained.tail<3>();
  other_[object] -= memory_.wrench[object];
}

void Coupling::carry(std::span<Cluster> clusters, PoseSpan now) const {
  for (std::size_t c = 0; c < grasps_.size(); ++c) {
    clusters[c].set_lead(grasps_[c].lead());
    if (!grasps_[c].held().empty()) clusters[c].carry(grasps_[c].motion(), grasps_[c].held(), now);
  }
}

void Coupling::forget() {
  for (Grasp& g : grasps_) g.forget();
}

void Coupling::push(std::span<const Cluster> clusters, const Physics* physics, Frame& frame) {
  for (Vec<double, 6>& w : memory_.wrench) w.setZero();
  collect(clusters, physics, frame);
  if (physics && !grasps_.empty()) {
    hold(clusters, *physics, frame);
  } else if (physics && !pushes_.empty()) {
    cap([](const Push& p) -> Vec3 { return p.most * p.along; }, options_.force_cap* options_.dt,
        [](Push& p, double over) { p.most /= over; });
    bound(*physics);
  }
  for (auto& part : memory_.part)
    for (Vec<double, 6>& w : part) w.setZero();
  add(clusters, frame);
}

void Coupling::collect(std::span<const Cluster> clusters, const Physics* physics, Frame& frame) {
  pushes_.clear();
  int first_body = 0;
  for (std::size_t c = 0; c < clusters.size(); first_body += static_cast<int>(clusters[c++].size())) {
    const Cluster& cluster = clusters[c];
    for (std::size_t r = 0; r < cluster.rows().size(); ++r) {
      const collision::Touch& t = cluster.rows()[r].touch;
      const auto body = at(t.a);
      const int object = cluster.object_of(t.b);
      const Pose<double>&start = cluster.solved_at()[body], &end = cluster.poses()[body];
      const Vec3 local = start.rotation.transpose() * (t.point_a - start.position);
      const Vec3 point = end * local;
      const double push = cluster.lambda(r) * options_.dt * options_.dt * options_.force_stiffness;
      const Vec3 friction = cluster.friction(r) * -(options_.dt * options_.dt * options_.force_stiffness);
      frame.contacts.push_back({first_body + t.a, object < 0 ? -1 - first_body - t.b : object, point, t.normal, t.gap,
                                std::min(push, options_.force_cap), friction});
      if (object < 0 || (push <= 0 && grasps_.empty()) || !surroundings_->objects[at(object)].loose() || !physics)
        continue;
      const Pose<double>& target = cluster.targets()[body];
      const Vec3 along = -t.normal, stretched = target * local;
      const double closing = along.dot(velocity_at(memory_.target_velocity[c][body], stretched - target.position));
      const double stretch = along.dot(stretched - point);
      Push p{};
      p.cluster = c, p.body = t.a, p.object = at(object), p.row = r;
      p.contact = frame.contacts.size() - 1;
      p.lever = t.point_a - physics->pose(p.object).position, p.along = along;
      p.most = push * options_.dt;
      p.god_at = start.position, p.object_at = t.point_a - p.lever;
      const Vec3 force = push * along + friction, arm = t.point_a - p.god_at;
      p.given << force, p.lever.cross(force);
      p.received << -force, -arm.cross(force);
      p.bound = std::min(std::max(closing, 0.0) + std::max(stretch, 0.0) / tau, share * memory_.hand_speed[c]);
      pushes_.push_back(p);
    }
  }
}

// What grasp.h says, where it has an answer; else what the step of the god objects itself says.
void Coupling::hold(std::span<const Cluster> clusters, const Physics& physics, Frame& frame) {
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    if (std::none_of(pushes_.begin(), pushes_.end(), [&](const Push& p) { return p.cluster == c; })) {
      grasps_[c].let_go();
      continue;
    }
    others_ = other_;
    for (std::size_t k = 0; k < clusters.size(); ++k)
      for (std::size_t o = 0; o < others_.size() && k != c; ++o) others_[o] += memory_.part[k][o];
    bool solved = false;
    {
      const Lap lap(frame.times.solve);
      solved = grasps_[c].solve(clusters[c], memory_.target_velocity[c], physics, others_,
                                left_of(options_, frame.times.solve));
    }
    if (grasps_[c].limited()) frame.came_from(Origin::limited);
    for (Push& p : pushes_) {
      if (p.cluster != c || !solved) continue;
      grasps_[c].read(p.row, p.given, p.received);
      p.god_at = clusters[c].poses()[at(p.body)].position;
      p.object_at = physics.pose(p.object).position;
    }
  }
  cap([](const Push& p) -> Vec3 { return p.given.head<3>(); }, options_.force_cap,
      [](Push& p, double over) { p.given /= over, p.received /= over; });
}

// The sum of a hand's pushes on one object.
template <class Of, class Shrink>
void Coupling::cap(const Of& of, double most, const Shrink& shrink) {
  for (const Push& first : pushes_) {
    Vec3 sum = Vec3::Zero();
    const auto same = [&](const Push& p) { return p.cluster == first.cluster && p.object == first.object; };
    for (const Push& p : pushes_)
      if (same(p)) sum += of(p);
    const double over = sum.norm() / most;
    if (!(over > 1)) continue;
    for (Push& p : pushes_)
      if (same(p)) shrink(p, over);
  }
}

void Coupling::bound(const Physics& physics) {
  for (Push& p : pushes_) {
    const Object& object = surroundings_->objects[p.object];
    const Vec3 turn = p.lever.cross(p.along);
    const Vec3 falls = velocity_at(physics.velocity(p.object), p.lever) + options_.dt * surroundings_->gravity;
    p.speed = p.along.dot(falls);
    p.ease = 1 / object.mass + turn.dot(inverse_inertia(object, physics.pose(p.object).rotation) * turn);
    p.impulse = 0;
    change_[p.object].setZero();
  }
  for (int sweep = 0; sweep < 200; ++sweep) {
    double most = 0;
    for (Push& p : pushes_) {
      const double speed = p.speed + p.along.dot(velocity_at(change_[p.object], p.lever));
      const double impulse = std::clamp(p.impulse + (p.bound - speed) / p.ease, 0.0, p.most),
                   more = impulse - p.impulse;
      const Object& object = surroundings_->objects[p.object];
      change_[p.object].head<3>() += more / object.mass * p.along;
      change_[p.object].tail<3>() +=
          inverse_inertia(object, physics.pose(p.object).rotation) * (more * p.lever.cross(p.along));
      p.impulse = impulse;
      most = std::max(most, std::abs(more) * p.ease);
    }
    if (most < 1e-9) break;  // m/s
  }
}

// The wrenches, and beside them what the rows of J give to the god objects: about the world's origin both are one sum.
void Coupling::add(std::span<const Cluster> clusters, Frame& frame) {
  Vec<double, 6> sum = Vec<double, 6>::Zero();
  double total = 0;
  for (Push& p : pushes_) {
    FrameContact& seen = frame.contacts[p.contact];
    if (grasps_.empty()) {
      p.given << p.impulse * p.along, p.lever.cross(p.impulse * p.along);
      p.received = p.impulse * clusters[p.cluster].contact_row(p.row, p.body);
      memory_.wrench[p.object] += p.given / options_.dt;
      seen.push = p.impulse / options_.dt;
      total += p.impulse * (1 + p.lever.norm());
    } else {
      memory_.wrench[p.object] += p.given;
      memory_.part[p.cluster][p.object] += p.given;
      seen.push = p.given.head<3>().dot(-seen.normal);
      seen.friction = p.given.head<3>() + seen.push * seen.normal;
      total += p.given.head<3>().norm() * (1 + p.lever.norm());
    }
    sum.head<3>() += p.given.head<3>() + p.received.head<3>();
    sum.tail<3>() += p.given.tail<3>() + p.object_at.cross(p.given.head<3>()) + p.received.tail<3>() +
                     p.god_at.cross(p.received.head<3>());
  }
  if (total > 0) frame.impulse_error = sum.norm() / total;
}

}  // namespace zwang::god
