#include <zwang/experiments/god_hand/measure/measures.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include <zwang/experiments/god_hand/step/following.h>

namespace zwang::god {
namespace {

// m: larger gaps are given as this. Other than the activation distance on purpose: World reuses the pairs of a query at
// the same distance, and the search of the next frame would look cheaper than it is.
constexpr double gap_reach = 1e-3;
constexpr double reached = 5e-4;  // m: so near to its target a god object is there
constexpr double speck = 1e-6;    // m

}  // namespace

Measures::Measures(const Surroundings& surroundings, std::span<const Cluster> clusters,
                   std::span<const hand::Model> models)
    : depth_(surroundings) {
  for (const hand::Model& model : models) balls_.push_back(balls(model));
  sight_.add(collision::Shape::sphere(speck));
  scenery_ = Scenery(sight_, surroundings, [](const Object&) { return Scenery::Role{}; });
  for (const Object& o : surroundings.objects) loose_.push_back(o.loose());
  memory_.late.assign(loose_.size(), 0);
  for (const Cluster& c : clusters) start_.insert(start_.end(), c.poses().begin(), c.poses().end());
  for (auto* poses : {&memory_.god[0], &memory_.god[1], &memory_.target[0], &memory_.target[1]}) *poses = start_;
}

void Measures::begin(std::span<const Cluster> clusters, PoseSpan objects) {
  start_object_.assign(objects.begin(), objects.end());
  start_.clear();
  for (const Cluster& c : clusters) start_.insert(start_.end(), c.poses().begin(), c.poses().end());
}

void Measures::show(std::span<const Cluster> clusters, const Options& options, Frame& frame) const {
  for (const Cluster& c : clusters) {
    frame.target.insert(frame.target.end(), c.targets().begin(), c.targets().end());
    frame.god.insert(frame.god.end(), c.poses().begin(), c.poses().end());
    frame.held = frame.held || c.held();
    // The coupling's spring, from each god object to its target.
    for (std::size_t b = 0; b < c.size(); ++b) {
      const Body& body = c.objects().scene.bodies[b];
      const Vec<double, 6> back = twist_between(c.targets()[b], c.poses()[b]);
      const Mat3& R = c.poses()[b].rotation;
      frame.device.emplace_back() << options.force_stiffness * body.mass * back.head<3>(),
          options.force_stiffness * (R * body.inertia * R.transpose() * back.tail<3>());
    }
  }
  frame.palm_wrench = frame.device[0];
}

void Measures::measure(std::span<Cluster> clusters, PoseSpan objects, const Options& options, Frame& frame) {
  std::size_t first = 0;
  for (Cluster& c : clusters) {
    frame.gap = std::min(frame.gap, c.gap(gap_reach));
    frame.separation = std::max(frame.separation, c.skeleton().separation(c.poses()));
    frame.limit = std::max(frame.limit, c.skeleton().excess(c.poses()));
    frame.lost_slide = std::max(frame.lost_slide, lost_slide(c));
    frame.rows += static_cast<int>(c.problem().rows());
    if (c.held()) frame.came_from(Origin::held);
    frame.stuck = frame.stuck || stuck(c, first);
    first += c.size();
  }
  for (std::size_t b = 0; b < frame.god.size(); ++b)
    frame.distance = std::max(frame.distance, (frame.god[b].position - frame.target[b].position).norm());
  frame.jitter = jitter(frame);
  measure_depth(objects, frame);
  if (options.mu > 0) measure_grip(objects, options, frame);
  std::swap(memory_.god[0], memory_.god[1]);
  std::swap(memory_.target[0], memory_.target[1]);
  memory_.god[1] = frame.god;
  memory_.target[1] = frame.target;
}

// In the sum over a cluster the forces of joints, limits and contacts within it cancel, and those of contacts with
// objects act along their normals. Orthogonal to all of those the centre of mass moves as the targets' does. What is
// missing of that is friction, which the model does not have.
double Measures::lost_slide(const Cluster& cluster) const {
  Mat3 normals = Mat3::Zero();
  for (const Contacts::Row& row : cluster.rows())
    if (cluster.object_of(row.touch.b) >= 0 && row.touch.gap <= hand::touching)
      normals += row.touch.normal * row.touch.normal.transpose();
  if (normals.isZero(0)) return 0;
  Vec3 missing = Vec3::Zero();
  double mass = 0;
  for (std::size_t b = 0; b < cluster.size(); ++b) {
    const double m = cluster.objects().scene.bodies[b].mass;
    missing += m * (cluster.targets()[b].position - cluster.poses()[b].position);
    mass += m;
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> axes(normals);
  Vec3 lost = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    if (axes.eigenvalues()[k] <= 1e-9 * axes.eigenvalues()[2])
      lost += axes.eigenvectors().col(k).dot(missing) * axes.eigenvectors().col(k);
  return lost.norm() / mass;
}

// Not at its target, no nearer to it than before, and nothing in the way.
bool Measures::stuck(Cluster& cluster, std::size_t first) const {
  double before = 0, after = 0;
  for (std::size_t b = 0; b < cluster.size(); ++b) {
    before = std::max(before, (cluster.targets()[b].position - start_[first + b].position).norm());
    after = std::max(after, (cluster.targets()[b].position - cluster.poses()[b].position).norm());
  }
  return after > reached && after > 0.999 * before && cluster.way_is_clear();
}

double Measures::jitter(const Frame& frame) const {
  double most = 0;
  for (std::size_t b = 0; b < frame.god.size(); ++b) {
    const auto bend = [b](const auto& last, const auto& now) {
      return (now[b].position - 2 * last[1][b].position + last[0][b].position).norm();
    };
    most = std::max(most, bend(memory_.god, frame.god) - bend(memory_.target, frame.target));
  }
  return most;
}

// What is held, and whether it moves along the fingers.
void Measures::measure_grip(PoseSpan objects, const Options& options, Frame& frame) {
  constexpr double settled = 0.5;   // s
  constexpr double nothing = 1e-6;  // N
  const bool rests = std::equal(frame.target.begin(), frame.target.end(), memory_.target[1].begin(), is_same);
  memory_.still = rests ? memory_.still + options.dt : 0;
  pressed_.assign(objects.size(), 0);
  wanted_.assign(objects.size(), 0);
  for (const FrameContact& c : frame.contacts) {
    if (c.object < 0 || !loose_[at(c.object)] || c.push <= nothing) continue;
    const auto body = at(c.body), object = at(c.object);
    const Vec3 apart = surface_way(start_[body], frame.god[body], c.point) -
                       surface_way(start_object_[object], objects[object], c.point);
    frame.slip = std::max(frame.slip, (apart - c.normal.dot(apart) * c.normal).norm() / options.dt);
    frame.friction_used = std::max(frame.friction_used, c.friction.norm() / (options.mu * c.push));
    frame.grip = std::max(frame.grip, (pressed_[object] += c.push) / 2);
    const Pose<double>&now = frame.god[body], &target = frame.target[body];
    const Vec3 wanted = target * Vec3(now.rotation.transpose() * (c.point - now.position));
    if (c.normal.dot(wanted - c.point) < 0) wanted_[object] = 1;
  }
  for (std::size_t o = 0; o < objects.size(); ++o) {
    memory_.late[o] = pressed_[o] > 0 && wanted_[o] == 0 ? memory_.late[o] + options.dt : 0;
    frame.late = std::max(frame.late, memory_.late[o]);
  }
  if (memory_.still >= settled) frame.creep = frame.slip;
}

// How deep the targets are in the objects, and whether one that is clear of all of them is behind one: a very small
// sphere that goes straight from the god object to it meets something.
void Measures::measure_depth(PoseSpan objects, Frame& frame) {
  for (std::size_t o = 0; o < objects.size(); ++o) scenery_.place(sight_, o, objects[o]);
  for (std::size_t h = 0; h < balls_.size(); ++h) {
    hand::Poses hand;
    std::copy_n(frame.target.begin() + static_cast<long>(h * hand.size()), hand.size(), hand.begin());
    const double depth = depth_.of(hand, balls_[h], 0, objects);
    frame.target_depth = std::max(frame.target_depth, depth);
    if (depth > 0) continue;
    for (std::size_t b = h * hand.size(); b < (h + 1) * hand.size() && !frame.behind; ++b) {
      const Vec3 from = frame.god[b].position, way = frame.target[b].position - from;
      if (way.norm() < reached) continue;
      sight_.place(0, {from, Mat3::Identity()});
      const collision::Move move{0, (Vec<double, 6>() << way, Vec3::Zero()).finished()};
      frame.behind = sight_.time_of_contact(std::span(&move, 1)).time < 1;
    }
  }
}

}  // namespace zwang::god
