#include <zwang/experiments/god_hand/step/simulation_state.h>

#include <algorithm>
#include <stdexcept>

#include <zwang/experiments/god_hand/step/lap.h>

namespace zwang::god {
namespace {

constexpr double touching = 1e-3;  // m: at this gap an object is touched

// The highest point of anything, in a direction [m].
double top_of(const Surroundings& surroundings, const Vec3& up) {
  double top = up.dot(surroundings.focus);
  const auto include = [&](const Pose<double>& pose, const Vec3& middle, const Vec3& half) {
    top = std::max(top, up.dot(pose * middle) + (pose.rotation.transpose() * up).cwiseAbs().dot(half));
  };
  for (const Object& o : surroundings.objects) {
    if (o.mesh) include(o.pose, (o.mesh->low() + o.mesh->high()) / 2, (o.mesh->high() - o.mesh->low()) / 2);
    for (const Object::Piece& piece : o.pieces)
      include(o.pose, piece.at.position, Vec3::Constant(reach_of(piece.shape)));
  }
  return top;
}

}  // namespace

Simulation::State::State(Surroundings surroundings_, const Options& options_)
    : surroundings(std::move(surroundings_)), options(options_) {
  for (const Object& o : surroundings.objects) object.push_back(o.pose);
  object_before = object;
}

void Simulation::State::build(std::vector<GodObjects> all, std::span<const Pose<double>> easy) {
  std::vector<collision::Shape> shapes;
  for (GodObjects& objects : all) {
    shapes.insert(shapes.end(), objects.shapes.begin(), objects.shapes.end());
    clusters.emplace_back(std::move(objects), surroundings, options);
    first.push_back(first.back() + clusters.back().size());
  }
  for (std::size_t c = 0; c < clusters.size(); ++c)
    start(clusters[c], of(c, target), easy.subspan(first[c], first[c + 1] - first[c]));
  if (std::any_of(surroundings.objects.begin(), surroundings.objects.end(),
                  [](const Object& o) { return o.loose(); })) {
    physics.emplace(surroundings);
    resolution.emplace(surroundings, shapes);
  }
  coupling.emplace(surroundings, options, clusters.size());
  measures.emplace(surroundings, clusters, models);
}

// Where nothing touches, at once. Else from above all objects down to there, as far as the way is clear; if the pose
// touches itself up there, from an easy one.
void Simulation::State::start(Cluster& cluster, std::span<const Pose<double>> at, std::span<const Pose<double>> easy) {
  cluster.place(at);
  if (cluster.gap(2 * options.gap) >= options.gap) return;
  const Vec3 up = surroundings.gravity.isZero() ? Vec3::UnitZ().eval() : (-surroundings.gravity.normalized()).eval();
  for (const std::span<const Pose<double>> poses : {at, easy}) {
    std::vector<Pose<double>> above(poses.begin(), poses.end());
    double lowest = up.dot(above[0].position);
    for (std::size_t b = 0; b < above.size(); ++b) {
      const collision::Shape& s = cluster.objects().shapes[b];
      lowest = std::min(lowest, up.dot(above[b].position) - s.reach() - s.radius());
    }
    const double rise = std::max(0.0, top_of(surroundings, up) + 0.01 - lowest);
    for (Pose<double>& pose : above) pose.position += rise * up;
    cluster.place(above);
    if (cluster.gap(2 * options.gap) < options.gap) continue;
    Frame ignored;
    cluster.aim(poses);
    while (!cluster.done()) cluster.commit(cluster.propose(ignored), ignored);
    return;
  }
  throw std::runtime_error("no clear place for the god objects to start: they touch each other at " +
                           std::to_string(at[0].position.x()) + " " + std::to_string(at[0].position.y()) + " " +
                           std::to_string(at[0].position.z()));
}

// Fig. 6 of the paper.
void Simulation::State::step() {
  measures->begin(clusters);
  if (physics) step_physics();
  step_god_objects();
  coupling->push(clusters, physics ? &*physics : nullptr, frame);
  for (const FrameContact& c : frame.contacts)
    if (c.object >= 0 && c.gap < touching && surroundings.objects[static_cast<std::size_t>(c.object)].loose())
      frame.object_speed =
          std::max(frame.object_speed, physics->velocity(static_cast<std::size_t>(c.object)).head<3>().norm());
  measures->look(clusters, object, options, frame);
}

// The engine first, with the forces of the last god-object step; then what it moved into god objects is moved out.
void Simulation::State::step_physics() {
  velocity_.assign(object.size(), Vec<double, 6>::Zero());
  const auto loose = [&](std::size_t o) { return surroundings.objects[o].loose(); };
  god.clear();
  for (const Cluster& c : clusters) god.insert(god.end(), c.poses().begin(), c.poses().end());
  for (std::size_t o = 0; o < object.size(); ++o)
    if (loose(o)) velocity_[o] = physics->velocity(o);
  object_before = object;
  {
    const Lap lap(frame.times.physics);
    physics->step(options.dt, coupling->wrenches());
  }
  for (std::size_t o = 0; o < object.size(); ++o)
    if (loose(o)) frame.work += options.dt * coupling->wrenches()[o].dot(velocity_[o] + physics->velocity(o)) / 2;
  {
    const Lap lap(frame.times.resolution);
    frame.returned = resolution->resolve(*physics, object_before, god).returned;
    for (std::size_t o = 0; o < object.size(); ++o) {
      if (!loose(o)) continue;
      object[o] = physics->pose(o);
      for (Cluster& c : clusters) c.place_object(o, object[o]);
    }
  }
  for (std::size_t o = 0; o < object.size(); ++o)
    if (loose(o)) frame.loose.push_back(object[o]);
}

// Section 6.3: sub-steps until nothing is in the way, at most so many. With `toc_of_all` every cluster goes as far as
// the one that meets something first (Algorithm 1); otherwise each as far as it can.
void Simulation::State::step_god_objects() {
  frame.claimed = Status::solved;
  if (options.verify > 0 && frame.number % options.verify == 0) frame.verified = Verdict::solved;
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    last_.assign(clusters[c].targets().begin(), clusters[c].targets().end());
    const Lap lap(frame.times.other);
    clusters[c].aim(of(c, target));
    coupling->aim(c, last_, clusters[c].targets());
  }
  const auto done = [](const Cluster& c) { return c.done(); };
  toc_.resize(clusters.size());
  while (!std::all_of(clusters.begin(), clusters.end(), done)) {
    double least = 1;
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      toc_[c] = done(clusters[c]) ? 1 : clusters[c].propose(frame);
      least = std::min(least, toc_[c]);
    }
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      if (done(clusters[c])) continue;
      if (watch) from_.assign(clusters[c].poses().begin(), clusters[c].poses().end());
      clusters[c].commit(options.toc_of_all ? least : toc_[c], frame);
      if (watch) watch(first[c], from_, clusters[c].poses());
    }
  }
}

}  // namespace zwang::god
