#include <zwang/experiments/god_hand/simulation.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include <zwang/experiments/god_hand/hand/each_number.h>
#include <zwang/experiments/god_hand/measure/measures.h>
#include <zwang/experiments/god_hand/step/coupling.h>
#include <zwang/experiments/god_hand/step/lap.h>
#include <zwang/experiments/god_hand/step/meeting.h>
#include <zwang/experiments/god_hand/step/physics.h>
#include <zwang/experiments/god_hand/step/resolution.h>

namespace zwang::god {
namespace {

std::string counts(std::size_t there, const char* what, std::size_t given, const char* of_what) {
  return std::to_string(there) + what + std::to_string(given) + of_what;
}

// The highest point of anything, in a direction [m].
double top_of(const Surroundings& surroundings, const Vec3& up) {
  double top = up.dot(surroundings.focus);
  const auto include = [&](const Pose<double>& pose, const Vec3& middle, const Vec3& half) {
    top = std::max(top, up.dot(pose * middle) + (pose.rotation.transpose() * up).cwiseAbs().dot(half));
  };
  for (const Object& o : surroundings.objects) {
    if (o.mesh) include(o.pose, o.mesh->box().center(), o.mesh->box().sizes() / 2);
    for (const Object::Piece& piece : o.pieces)
      include(o.pose, piece.at.position, Vec3::Constant(reach_of(piece.shape)));
  }
  return top;
}

}  // namespace

struct Simulation::State {
  State(Surroundings surroundings, const Options& options);

  // Takes the clusters over; `target` has their poses already. `easy`: as target, where a hand does not touch itself.
  void build(std::vector<GodObjects> objects, PoseSpan easy);
  void step();
  // Every number of the state between frames: visit(number), for writing and for reading.
  template <class Visit>
  void each_number(bool reading, const Visit& visit);

  Surroundings surroundings;
  Options options;
  std::vector<hand::Model> models;
  std::vector<Cluster> clusters;
  std::optional<Meeting> meeting;        // of two hands that are clusters of their own
  std::vector<std::size_t> first = {0};  // god object of each cluster, and their number
  std::vector<Pose<double>> target;      // of all god objects, the last that was tracked
  std::optional<Physics> physics;        // where something is loose
  std::optional<Resolution> resolution;
  std::vector<Coupling> couplings;  // of the hands as clusters of their own; where they may meet, of both as one
  std::optional<Measures> measures;
  std::vector<std::size_t> loose;  // objects
  std::vector<Pose<double>> object, object_before, god;
  std::vector<Pose<double>> wanted;  // of all god objects, where the hands are tracked now
  Watch watch = {};
  Frame frame = {};
  long number = 0;

  bool together() const { return meeting && meeting->together(); }
  // The clusters of this frame: each hand, or both as one.
  std::span<Cluster> active() { return together() ? std::span(&meeting->both(), 1) : std::span(clusters); }
  Coupling& pushes() { return couplings[together()]; }
  std::vector<collision::Shape> shapes() const {
    std::vector<collision::Shape> all;
    for (const Cluster& c : clusters) all.insert(all.end(), c.objects().shapes.begin(), c.objects().shapes.end());
    return all;
  }
  template <class Visit>
  void each_cluster(const Visit& visit) {
    for (Cluster& c : clusters) visit(c);
    if (meeting) visit(meeting->both());
  }

  // Of an active cluster.
  template <class T>
  std::span<const T> of(std::size_t cluster, const std::vector<T>& all) const {
    return together() ? std::span(all) : std::span(all).subspan(first[cluster], first[cluster + 1] - first[cluster]);
  }

 private:
  void start(Cluster& cluster, PoseSpan at, PoseSpan easy);
  void step_physics();
  void meet();
  void step_god_objects();

  std::vector<Vec<double, 6>> velocity_;  // by object, before the engine's step
  std::vector<Pose<double>> last_;        // of a cluster, its targets of the frame before
  std::vector<double> toc_;               // by cluster
  std::vector<Pose<double>> from_;        // of a cluster, before a motion that is watched
};

Simulation::State::State(Surroundings surroundings_, const Options& options_)
    : surroundings(std::move(surroundings_)), options(chosen(options_)) {
  for (const Object& o : surroundings.objects) {
    if (o.loose()) loose.push_back(object.size());
    object.push_back(o.pose);
  }
  object_before = object;
}

void Simulation::State::build(std::vector<GodObjects> all, PoseSpan easy) {
  for (GodObjects& objects : all) {
    clusters.emplace_back(std::move(objects), surroundings, options);
    first.push_back(first.back() + clusters.back().size());
  }
  for (std::size_t c = 0; c < clusters.size(); ++c)
    start(clusters[c], of(c, target), easy.subspan(first[c], first[c + 1] - first[c]));
  if (!loose.empty()) {
    physics.emplace(surroundings);
    resolution.emplace(surroundings, shapes());
  }
  couplings.emplace_back(surroundings, options, clusters);
  if (meeting) couplings.emplace_back(surroundings, options, std::span(&meeting->both(), 1));
  measures.emplace(surroundings, clusters, models);
}

// Where nothing touches, at once. Else from above all objects down to there, as far as the way is clear; if the pose
// touches itself up there, from an easy one.
void Simulation::State::start(Cluster& cluster, PoseSpan at, PoseSpan easy) {
  cluster.place(at);
  if (cluster.gap(2 * options.gap) >= options.gap) return;
  const Vec3 up = surroundings.gravity.isZero() ? Vec3::UnitZ().eval() : (-surroundings.gravity.normalized()).eval();
  for (const PoseSpan poses : {at, easy}) {
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
  const Vec3& p = at[0].position;
  throw std::runtime_error(printed("no clear place for the god objects to start: within the gap of %g m at %g %g %g",
                                   options.gap, p.x(), p.y(), p.z()));
}

// Fig. 6 of the paper.
void Simulation::State::step() {
  if (options.measured) measures->begin(active(), object);
  if (physics) step_physics();
  if (meeting) meet();
  step_god_objects();
  pushes().push(active(), physics ? &*physics : nullptr, frame);
  for (const FrameContact& c : frame.contacts)
    if (c.object >= 0 && c.gap <= hand::touching && surroundings.objects[at(c.object)].loose())
      frame.object_speed = std::max(frame.object_speed, physics->velocity(at(c.object)).head<3>().norm());
  {
    const Lap lap(frame.times.other);
    measures->show(active(), options, frame);
  }
  if (options.measured) measures->measure(active(), object, options, frame);
}

// The engine first, with the forces of the last god-object step; then what it moved into god objects is moved out.
void Simulation::State::step_physics() {
  velocity_.resize(object.size());
  for (const std::size_t o : loose) velocity_[o] = physics->velocity(o);
  object_before = object;
  {
    const Lap lap(frame.times.physics);
    physics->step(options.dt, pushes().wrenches());
  }
  for (const std::size_t o : loose) {
    const Vec<double, 6> velocity = physics->velocity(o);
    frame.work += options.dt * pushes().wrenches()[o].dot(velocity_[o] + velocity) / 2;
    pushes().observe(o, velocity_[o], velocity, physics->pose(o).rotation);
  }
  {
    const Lap lap(frame.times.sweep);
    for (const std::size_t o : loose) object[o] = physics->pose(o);
    pushes().carry(active(), object);
  }
  {
    const Lap lap(frame.times.resolution);
    const auto resolve = [&] {
      god.clear();
      for (const Cluster& c : active()) god.insert(god.end(), c.poses().begin(), c.poses().end());
      return resolution->resolve(*physics, object_before, god).returned;
    };
    // An object that goes back to where it was may there be in a hand that was carried on.
    frame.returned = resolve();
    bool back = false;
    if (frame.returned > 0)
      for (Cluster& c : active()) back = c.put_back() || back;
    if (back) frame.returned += resolve();
    for (const std::size_t o : loose) {
      object[o] = physics->pose(o);
      for (Cluster& c : active()) c.place_object(o, object[o]);
    }
  }
  for (const std::size_t o : loose) frame.loose.push_back(object[o]);
}

// Hands that come near each other become one cluster, with the forces and speeds that they had.
void Simulation::State::meet() {
  const Coupling::Memory& before = pushes().memory();
  if (!meeting->decide(clusters, target)) return;
  Coupling::Memory& now = pushes().memory();
  now.wrench = before.wrench;
  now.part.assign(now.part.size(), std::vector<Vec<double, 6>>(object.size(), Vec<double, 6>::Zero()));
  now.part[0] = before.wrench;
  now.hand_speed.assign(now.hand_speed.size(), *std::ranges::max_element(before.hand_speed));
  now.since.assign(now.since.size(), *std::ranges::min_element(before.since));
  now.between.assign(now.between.size(), *std::ranges::max_element(before.between));
  std::vector<Vec<double, 6>> velocity;
  for (const auto& of_cluster : before.target_velocity)
    velocity.insert(velocity.end(), of_cluster.begin(), of_cluster.end());
  auto from = velocity.cbegin();
  for (auto& of_cluster : now.target_velocity)
    for (Vec<double, 6>& v : of_cluster) v = *from++;
  for (const std::size_t o : loose)
    for (Cluster& c : active()) c.place_object(o, object[o]);
}

// Section 6.3: sub-steps until nothing is in the way, at most so many. With `toc_of_all` every cluster goes as far as
// the one that meets something first (Algorithm 1); otherwise each as far as it can.
void Simulation::State::step_god_objects() {
  frame.claimed = Status::solved;
  if (options.verify > 0 && frame.number % options.verify == 0) frame.verified = Verdict::solved;
  const std::span<Cluster> clusters = active();
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    last_.assign(clusters[c].targets().begin(), clusters[c].targets().end());
    const Lap lap(frame.times.other);
    clusters[c].aim(of(c, target));
    pushes().aim(c, last_, clusters[c].targets());
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
      if (watch) watch(together() ? 0 : first[c], from_, clusters[c].poses());
    }
  }
}

template <class Visit>
void Simulation::State::each_number(bool reading, const Visit& visit) {
  const auto each = [&visit](auto&... values) { (god::each_number(values, visit), ...); };
  each(number, target);
  if (meeting) {
    bool one = together();
    each(one);
    meeting->set_together(one);
  }
  each_cluster([&](Cluster& c) {
    Cluster::Memory m = c.memory();
    each(m.pose, m.target, m.last_step, m.met_at, m.followed, m.next, m.step_scale);
    if (reading) c.restore(m);
  });
  for (Coupling& c : couplings) {
    Coupling::Memory& m = c.memory();
    each(m.hand_speed, m.since, m.between, m.target_velocity, m.wrench, m.part);
    for (Grasp& g : c.grasps()) {
      Grasp::Hold h = g.hold();
      each(h.motion, h.objects, h.lead);
      if (reading) g.take(h);
    }
  }
  Measures::Memory& seen = measures->memory();
  each(seen.still, seen.late, seen.god[0], seen.target[0], seen.god[1], seen.target[1], object);
  for (const std::size_t o : loose) {
    Pose<double> pose = physics->pose(o);
    Vec<double, 6> velocity = physics->velocity(o);
    each(pose, velocity);
    if (!reading) continue;
    physics->place(o, pose, velocity);
    each_cluster([&](Cluster& c) { c.place_object(o, object[o]); });
  }
  if (!reading) return;
  if (physics) physics->forget();
  for (Coupling& c : couplings) c.forget();
}

std::vector<double> Simulation::checkpoint() {
  std::vector<double> numbers;
  state_->each_number(false, write_numbers(numbers));
  restore(numbers);
  return numbers;
}

void Simulation::restore(std::span<const double> checkpoint) {
  std::size_t count = 0;
  state_->each_number(false, [&](const auto&) { ++count; });
  if (checkpoint.size() != count) throw std::runtime_error("not a checkpoint of this simulation");
  const double* from = checkpoint.data();
  state_->each_number(true, take_numbers(from));
}

Simulation::Simulation(Surroundings surroundings, std::span<const hand::Model> models, std::span<const Target> start,
                       const Options& options)
    : state_(std::make_unique<State>(std::move(surroundings), options)) {
  if (models.size() != start.size() || models.empty())
    throw std::invalid_argument(counts(models.size(), " hands, ", start.size(), " starts"));
  State& s = *state_;
  s.models.assign(models.begin(), models.end());
  const double reach = options.limits == Options::Limits::predictive ? 0.25 : 0;  // rad
  std::vector<GodObjects> clusters;
  std::vector<Pose<double>> easy;
  for (std::size_t h = 0; h < models.size(); ++h) {
    const hand::Poses at = hand::forward_kinematics(start[h].palm, start[h].angles, models[h]),
                      straight = hand::forward_kinematics(start[h].palm, {}, models[h]);
    if (!std::ranges::all_of(at, is_usable))
      throw std::runtime_error("a hand's first target is not finite, or farther than 1e6 m from the origin");
    s.target.insert(s.target.end(), at.begin(), at.end());
    easy.insert(easy.end(), straight.begin(), straight.end());
    if (clusters.empty() || options.clusters) clusters.emplace_back();
    const std::string prefix = models.size() == 1 ? "" : models[h].left ? "left " : "right ";
    add_hand(clusters.back(), models[h], start[h], prefix, reach);
  }
  if (options.clusters && options.hands_meet && models.size() == 2) {
    GodObjects both;
    for (std::size_t h = 0; h < models.size(); ++h)
      add_hand(both, models[h], start[h], h == 0 ? "" : "left ", reach, true);
    s.meeting.emplace(std::move(both), static_cast<std::size_t>(hand::bodies), s.surroundings, s.options);
  }
  s.build(std::move(clusters), easy);
}

Simulation::Simulation(Surroundings surroundings, std::vector<GodObjects> clusters, const Options& options,
                       std::vector<Pose<double>> easy)
    : state_(std::make_unique<State>(std::move(surroundings), options)) {
  if (clusters.empty()) throw std::invalid_argument("no god objects");
  for (const GodObjects& objects : clusters) {
    if (objects.shapes.empty() || objects.shapes.size() != objects.scene.bodies.size())
      throw std::invalid_argument(
          counts(objects.scene.bodies.size(), " god objects, ", objects.shapes.size(), " shapes"));
    for (const Body& body : objects.scene.bodies) state_->target.push_back(body.pose);
  }
  if (easy.empty()) easy = state_->target;
  if (easy.size() != state_->target.size())
    throw std::invalid_argument(counts(state_->target.size(), " god objects, ", easy.size(), " easy poses"));
  state_->build(std::move(clusters), easy);
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;

void Simulation::watch(Watch watch) { state_->watch = std::move(watch); }

PoseSpan Simulation::object_poses() const { return state_->object; }

const Problem& Simulation::problem(std::size_t cluster) const {
  const std::span<Cluster> clusters = state_->active();
  if (cluster >= clusters.size()) throw std::out_of_range("cluster " + std::to_string(cluster));
  return clusters[cluster].problem();
}

std::vector<collision::Shape> Simulation::shapes() const { return state_->shapes(); }

const Frame& Simulation::step(std::span<const Target> targets) {
  State& s = *state_;
  if (targets.size() != s.models.size())
    throw std::invalid_argument(counts(s.models.size(), " hands, ", targets.size(), " targets"));
  s.wanted = s.target;
  bool tracked = true;
  for (std::size_t h = 0; h < targets.size(); ++h) {
    const hand::Poses at = hand::forward_kinematics(targets[h].palm, targets[h].angles, s.models[h]);
    const bool usable = targets[h].tracked && std::ranges::all_of(at, is_usable);
    tracked = tracked && usable;
    if (usable) std::copy(at.begin(), at.end(), s.wanted.begin() + static_cast<long>(h * at.size()));
  }
  step(s.wanted);
  s.frame.tracked = tracked;
  return s.frame;
}

const Frame& Simulation::step(PoseSpan targets) {
  State& s = *state_;
  if (targets.size() != s.target.size())
    throw std::invalid_argument(counts(s.target.size(), " god objects, ", targets.size(), " targets"));
  s.frame.reset();
  s.frame.tracked = std::ranges::all_of(targets, is_usable);
  if (s.frame.tracked) std::copy(targets.begin(), targets.end(), s.target.begin());
  s.frame.number = s.number++;
  s.frame.time = static_cast<double>(s.frame.number) * s.options.dt;
  s.step();
  return s.frame;
}

}  // namespace zwang::god
