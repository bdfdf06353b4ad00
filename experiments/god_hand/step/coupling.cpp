#include <zwang/experiments/god_hand/step/coupling.h>

#include <algorithm>
#include <cmath>

namespace zwang::god {
namespace {

constexpr double tau = 0.1, fade = 0.5;  // s
constexpr double share = 1.5;            // of the hand's speed

Vec3 velocity_at(const Vec<double, 6>& twist, const Vec3& lever) {
  return twist.head<3>() + twist.tail<3>().cross(lever);
}

Mat3 inverse_inertia(const Object& object, const Mat3& rotation) {
  return rotation * object.inertia.inverse() * rotation.transpose();
}

}  // namespace

Coupling::Coupling(const Surroundings& surroundings, const Options& options, std::size_t clusters)
    : surroundings_(&surroundings),
      options_(options),
      memory_{std::vector<double>(clusters, 0),
              std::vector<Vec<double, 6>>(surroundings.objects.size(), Vec<double, 6>::Zero())},
      target_velocity_(clusters),
      change_(memory_.wrench) {}

void Coupling::aim(std::size_t cluster, std::span<const Pose<double>> last, std::span<const Pose<double>> now) {
  std::vector<Vec<double, 6>>& velocity = target_velocity_[cluster];
  velocity.resize(now.size());
  double fastest = 0;
  for (std::size_t b = 0; b < now.size(); ++b) {
    velocity[b] = twist_between(last[b], now[b]) / options_.dt;
    fastest = std::max(fastest, velocity[b].head<3>().norm());
  }
  if (fastest > options_.fastest) {
    for (Vec<double, 6>& v : velocity) v.setZero();
    fastest = 0;
  }
  memory_.hand_speed[cluster] = std::max(fastest, memory_.hand_speed[cluster] * std::exp(-options_.dt / fade));
}

void Coupling::push(std::span<const Cluster> clusters, const Physics* physics, Frame& frame) {
  for (Vec<double, 6>& w : memory_.wrench) w.setZero();
  collect(clusters, physics, frame);
  if (!physics || pushes_.empty()) return;
  cap();
  bound(*physics);
  add(clusters, frame);
}

void Coupling::collect(std::span<const Cluster> clusters, const Physics* physics, Frame& frame) {
  pushes_.clear();
  int first_body = 0;
  for (std::size_t c = 0; c < clusters.size(); first_body += static_cast<int>(clusters[c++].size())) {
    const Cluster& cluster = clusters[c];
    for (std::size_t r = 0; r < cluster.rows().size(); ++r) {
      const collision::Touch& t = cluster.rows()[r].touch;
      const auto body = static_cast<std::size_t>(t.a);
      const int object = cluster.object_of(t.b);
      const Pose<double>&start = cluster.solved_at()[body], &end = cluster.poses()[body];
      const Vec3 local = start.rotation.transpose() * (t.point_a - start.position);
      const Vec3 point = end * local;
      const double push = cluster.lambda(r) * options_.dt * options_.dt * options_.force_stiffness;
      frame.contacts.push_back({first_body + t.a, object < 0 ? -1 - first_body - t.b : object, point, t.normal, t.gap,
                                std::min(push, options_.force_cap)});
      if (object < 0 || push <= 0 || !surroundings_->objects[static_cast<std::size_t>(object)].loose() || !physics)
        continue;
      const Pose<double>& target = cluster.targets()[body];
      const Vec3 along = -t.normal, stretched = target * local;
      const double closing = along.dot(velocity_at(target_velocity_[c][body], stretched - target.position));
      const double stretch = along.dot(stretched - point);
      Push p{};
      p.cluster = c, p.body = t.a, p.object = static_cast<std::size_t>(object), p.row = r;
      p.contact = frame.contacts.size() - 1;
      p.lever = t.point_a - physics->pose(p.object).position, p.along = along;
      p.most = push * options_.dt;
      p.bound = std::min(std::max(closing, 0.0) + std::max(stretch, 0.0) / tau, share * memory_.hand_speed[c]);
      pushes_.push_back(p);
    }
  }
}

// The sum of a hand's pushes on one object.
void Coupling::cap() {
  for (Push& first : pushes_) {
    Vec3 sum = Vec3::Zero();
    const auto same = [&](const Push& p) { return p.cluster == first.cluster && p.object == first.object; };
    for (const Push& p : pushes_)
      if (same(p)) sum += p.most * p.along;
    const double over = sum.norm() / (options_.force_cap * options_.dt);
    if (over <= 1) continue;
    for (Push& p : pushes_)
      if (same(p)) p.most /= over;
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
  for (const Push& p : pushes_) {
    Vec<double, 6> on_object;
    on_object << p.impulse * p.along, p.lever.cross(p.impulse * p.along);
    memory_.wrench[p.object] += on_object / options_.dt;
    frame.contacts[p.contact].push = p.impulse / options_.dt;

    const Cluster& cluster = clusters[p.cluster];
    const Vec<double, 6> on_god = p.impulse * cluster.contact_row(p.row, p.body);
    const Vec3 god_at = cluster.solved_at()[static_cast<std::size_t>(p.body)].position;
    const Vec3 object_at = cluster.rows()[p.row].touch.point_a - p.lever;
    sum.head<3>() += on_object.head<3>() + on_god.head<3>();
    sum.tail<3>() +=
        on_object.tail<3>() + object_at.cross(on_object.head<3>()) + on_god.tail<3>() + god_at.cross(on_god.head<3>());
    total += p.impulse * (1 + p.lever.norm());
  }
  if (total > 0) frame.impulse_error = sum.norm() / total;
}

}  // namespace zwang::god
