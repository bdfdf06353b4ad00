#include "experiments/god/simulation.h"

#include <algorithm>
#include <stdexcept>

#include "experiments/god/cluster.h"
#include "experiments/god/lap.h"

namespace zwang::god {
namespace {

bool finite(const Pose<double>& pose) { return pose.position.allFinite() && pose.rotation.allFinite(); }

// Above everything, in the direction that gravity does not pull.
double top_of(const Surroundings& surroundings, const Vec3& up) {
  double top = up.dot(surroundings.focus);
  const auto include = [&](const Pose<double>& pose, const Vec3& middle, const Vec3& half) {
    top = std::max(top, up.dot(pose * middle) + (pose.rotation.transpose() * up).cwiseAbs().dot(half));
  };
  for (const Object& o : surroundings.objects) {
    if (o.mesh) include(o.pose, (o.mesh->low() + o.mesh->high()) / 2, (o.mesh->high() - o.mesh->low()) / 2);
    for (const Object::Piece& piece : o.pieces)
      include(o.pose, piece.at.position, Vec3::Constant(piece.shape.reach() + piece.shape.radius()));
  }
  return top;
}

}  // namespace

struct Simulation::State {
  Surroundings surroundings;
  Options options;
  std::vector<hand::Model> models;
  std::vector<Cluster> clusters;
  std::vector<Pose<double>> target;  // of all god objects, cluster after cluster
  Frame frame = {};
  long number = 0;

  std::span<const Pose<double>> target_of(std::size_t cluster) const {
    std::size_t first = 0;
    for (std::size_t c = 0; c < cluster; ++c) first += clusters[c].size();
    return std::span(target).subspan(first, clusters[cluster].size());
  }
  void start(Cluster& cluster, std::span<const Pose<double>> at, std::span<const Pose<double>> easy);
  void step_god_objects();
  void measure();
};

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

Simulation::Simulation(Surroundings surroundings, std::span<const hand::Model> models, std::span<const Target> start,
                       const Options& options)
    : state_(std::make_unique<State>(std::move(surroundings), options)) {
  if (models.size() != start.size() || models.empty())
    throw std::invalid_argument(std::to_string(models.size()) + " hands, " + std::to_string(start.size()) + " starts");
  State& s = *state_;
  s.models.assign(models.begin(), models.end());
  const double reach = options.limits == Options::Limits::predictive ? 0.25 : 0;  // rad
  std::vector<GodObjects> clusters;
  for (std::size_t h = 0; h < models.size(); ++h) {
    if (clusters.empty() || options.clusters) clusters.emplace_back();
    const std::string prefix = models.size() == 1 ? "" : models[h].left ? "left " : "right ";
    add_hand(clusters.back(), models[h], start[h], prefix, reach);
  }
  std::vector<Pose<double>> easy;
  for (std::size_t h = 0; h < models.size(); ++h) {
    const hand::Poses at = hand::assemble(start[h].palm, start[h].angles, models[h]),
                      straight = hand::assemble(start[h].palm, {}, models[h]);
    s.target.insert(s.target.end(), at.begin(), at.end());
    easy.insert(easy.end(), straight.begin(), straight.end());
  }
  if (!std::all_of(s.target.begin(), s.target.end(), finite))
    throw std::runtime_error("the hand's first target is not finite");
  for (GodObjects& objects : clusters) s.clusters.emplace_back(std::move(objects), s.surroundings, options);
  std::size_t first = 0;
  for (std::size_t c = 0; c < s.clusters.size(); first += s.clusters[c++].size())
    s.start(s.clusters[c], s.target_of(c), std::span(easy).subspan(first, s.clusters[c].size()));
}

Simulation::Simulation(Surroundings surroundings, std::vector<GodObjects> clusters, const Options& options)
    : state_(std::make_unique<State>(std::move(surroundings), options)) {
  State& s = *state_;
  for (GodObjects& objects : clusters) {
    for (const Body& body : objects.scene.bodies) s.target.push_back(body.pose);
    s.clusters.emplace_back(std::move(objects), s.surroundings, options);
  }
  for (std::size_t c = 0; c < s.clusters.size(); ++c) s.start(s.clusters[c], s.target_of(c), s.target_of(c));
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;

const Surroundings& Simulation::surroundings() const { return state_->surroundings; }

std::vector<collision::Shape> Simulation::shapes() const {
  std::vector<collision::Shape> all;
  for (const Cluster& c : state_->clusters) all.insert(all.end(), c.objects().shapes.begin(), c.objects().shapes.end());
  return all;
}

const Frame& Simulation::step(std::span<const Target> targets) {
  State& s = *state_;
  if (targets.size() != s.models.size())
    throw std::invalid_argument(std::to_string(s.models.size()) + " hands, " + std::to_string(targets.size()) +
                                " targets");
  std::vector<Pose<double>> poses = s.target;
  bool tracked = true;
  for (std::size_t h = 0; h < targets.size(); ++h) {
    const hand::Poses at = hand::assemble(targets[h].palm, targets[h].angles, s.models[h]);
    const bool usable = targets[h].tracked && std::all_of(at.begin(), at.end(), finite);
    tracked = tracked && usable;
    if (usable) std::copy(at.begin(), at.end(), poses.begin() + static_cast<long>(h * at.size()));
  }
  step(poses);
  s.frame.tracked = tracked;
  return s.frame;
}

const Frame& Simulation::step(std::span<const Pose<double>> targets) {
  State& s = *state_;
  if (targets.size() != s.target.size())
    throw std::invalid_argument(std::to_string(s.target.size()) + " god objects, " + std::to_string(targets.size()) +
                                " targets");
  s.frame = {};
  s.frame.tracked = std::all_of(targets.begin(), targets.end(), finite);
  if (s.frame.tracked) std::copy(targets.begin(), targets.end(), s.target.begin());
  s.frame.number = s.number++;
  s.frame.time = static_cast<double>(s.frame.number) * s.options.dt;
  s.step_god_objects();
  s.measure();
  return s.frame;
}

// Section 6.3: sub-steps until nothing is in the way, at most so many. With `toc_of_all` every cluster goes as far as
// the one that meets something first (Algorithm 1); otherwise each as far as it can.
void Simulation::State::step_god_objects() {
  frame.claimed = Status::solved;
  if (options.verify) frame.verified = Verdict::solved;
  {
    const Lap lap(frame.times.other);
    for (std::size_t c = 0; c < clusters.size(); ++c) clusters[c].aim(target_of(c));
  }
  const auto done = [](const Cluster& c) { return c.done(); };
  while (!std::all_of(clusters.begin(), clusters.end(), done)) {
    double first = 1;
    std::vector<double> toc;
    for (Cluster& c : clusters) {
      toc.push_back(c.done() ? 1 : c.propose(frame));
      first = std::min(first, toc.back());
    }
    for (std::size_t c = 0; c < clusters.size(); ++c)
      if (!clusters[c].done()) clusters[c].commit(options.toc_of_all ? first : toc[c], frame);
  }
}

void Simulation::State::measure() {
  for (Cluster& c : clusters) {
    frame.target.insert(frame.target.end(), c.targets().begin(), c.targets().end());
    frame.god.insert(frame.god.end(), c.poses().begin(), c.poses().end());
    frame.gap = std::min(frame.gap, c.gap(2e-3));
    frame.separation = std::max(frame.separation, c.skeleton().separation(c.poses()));
    frame.limit = std::max(frame.limit, c.skeleton().excess(c.poses()));
    for (std::size_t b = 0; b < c.size(); ++b)
      frame.distance = std::max(frame.distance, (c.poses()[b].position - c.targets()[b].position).norm());
    frame.rows += static_cast<int>(c.problem().rows());
    frame.held = frame.held || c.held();
  }
}

}  // namespace zwang::god
