#include <zwang/bench/collision/study.h>

#include <btBulletCollisionCommon.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <zwang/bench/collision/meshes.h>
#include <zwang/bench/collision/witness.h>
#include <zwang/bench/results/statistics.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/collision/world.h>
#include <zwang/core/problem/cpu_clock.h>

namespace zwang {
namespace {

using collision::Move;
using collision::Shape;
using collision::Tree;
using collision::World;

constexpr double stop = 1e-4;  // m: where motions are stopped

// What reading the clock costs [s]: a system call, half a microsecond, a sixth of a query on a small mesh.
double clock_cost() {
  double least = 1;
  for (int k = 0; k < 1000; ++k) {
    const double start = thread_cpu_seconds();
    least = std::min(least, thread_cpu_seconds() - start);
  }
  return least;
}

// The query's answer; `times` gets how long it took.
template <class Query>
double timed(std::vector<double>& times, const Query& query) {
  static const double clock = clock_cost();
  const double start = thread_cpu_seconds();
  const double answer = query();
  times.push_back(std::max(0.0, thread_cpu_seconds() - start - clock));
  return answer;
}

// The nearest surface, looked for within 1 cm.
double gap_of(World& world) {
  double least = 0.01;
  for (const collision::Touch& t : world.touches(0.01)) least = std::min(least, t.gap);
  return least;
}

// Bullet's convexSweepTest of a capsule against a mesh, in double precision, as a rival. Translation and the turn
// between two poses, as Bullet takes them.
class BulletSweep {
 public:
  explicit BulletSweep(const Tree& mesh) {
    const auto point = [](const Vec3& p) { return btVector3(p.x(), p.y(), p.z()); };
    for (const collision::Triangle& t : mesh.triangles())
      triangles_.addTriangle(point(t.corner[0]), point(t.corner[1]), point(t.corner[2]));
    shape_ = std::make_unique<btBvhTriangleMeshShape>(&triangles_, true);
    shape_->setMargin(0);
    object_.setCollisionShape(shape_.get());
    world_.addCollisionObject(&object_);
  }
  ~BulletSweep() { world_.removeCollisionObject(&object_); }
  BulletSweep(BulletSweep&&) = delete;

  double time(const Shape& shape, const Pose<double>& from, const Pose<double>& to) const {
    const btCapsuleShape capsule(shape.radius(), 2 * shape.half().y());  // along y, as ours
    btCollisionWorld::ClosestConvexResultCallback found(transform(from).getOrigin(), transform(to).getOrigin());
    world_.convexSweepTest(&capsule, transform(from), transform(to), found);
    return found.m_closestHitFraction;
  }

 private:
  static btTransform transform(const Pose<double>& pose) {
    const Mat3& R = pose.rotation;
    const Vec3& p = pose.position;
    return btTransform(btMatrix3x3(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
                       btVector3(p.x(), p.y(), p.z()));
  }

  btTriangleMesh triangles_;
  std::unique_ptr<btBvhTriangleMeshShape> shape_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btCollisionWorld world_{&dispatcher_, &broad_phase_, &configuration_};
  btCollisionObject object_;
};

struct Placement {
  Pose<double> pose;
  Vec<double, 6> twist;
};

struct Pairs {
  std::shared_ptr<const Tree> tree;
  Shape finger;
  std::vector<Placement> placements;
};

Pairs make_pairs(std::size_t triangles, double gap, const std::string& motion, int count) {
  Pairs pairs{
      std::make_shared<const Tree>(meshes::bumpy_sphere(0.15, 0.006, 8, triangles)), Shape::capsule(0.04, 0.008), {}};
  Draw draw(5);
  World world;
  world.add(pairs.tree);
  const int finger = world.add(pairs.finger);
  while (static_cast<int>(pairs.placements.size()) < count) {
    // From outside toward the middle until the gap is what was asked for.
    const Vec3 out = draw.direction();
    Pose<double> pose{0.25 * out, rotation(draw.cube(2))};
    for (int k = 0; k < 60; ++k) {
      world.place(finger, pose);
      const double here = gap_of(world);
      if (here < 0.01 && std::abs(here - gap) < 1e-3 * gap) break;
      pose.position -= (here - gap) * out * (here < 0.01 ? 0.9 : 1);
    }
    world.place(finger, pose);
    double least = 1;
    Vec3 n = out;
    for (const collision::Touch& t : world.touches(0.03))
      if (t.gap < least) least = t.gap, n = t.normal;
    if (std::abs(least - gap) > 0.05 * gap) continue;
    const Vec3 along = n.unitOrthogonal();
    Vec<double, 6> twist;
    twist << 1e-3 * (motion == "pressing"  ? Vec3(-n)
                     : motion == "sliding" ? along
                                           : Vec3(0.7 * along - 0.7 * n)),
        draw.cube(2e-3);
    pairs.placements.push_back({pose, twist});
  }
  return pairs;
}

constexpr std::array<const char*, 3> methods = {"zwang", "fcl", "bullet"};

}  // namespace

PairStudy study_pairs(std::size_t triangles, double gap, const std::string& motion, int count) {
  const Pairs pairs = make_pairs(triangles, gap, motion, count);
  PairStudy s{.triangles = pairs.tree->size(), .gap = gap, .motion = motion, .placements = count};
  World world;
  world.add(pairs.tree);
  const int finger = world.add(pairs.finger);
  const auto end_gap = [&](const Placement& p, double time) {
    world.place(finger, retract(p.pose, Vec<double, 6>(time * p.twist)));
    return gap_of(world);
  };
  World asked;
  asked.add(pairs.tree);
  const int body = asked.add(pairs.finger);
  const Witness witness(std::span(&pairs.tree, 1));
  const BulletSweep sweep(*pairs.tree);
  // Where a motion ends, as a part of it.
  const std::array<std::function<double(const Placement&)>, methods.size()> query = {
      [&](const Placement& p) {
        asked.place(body, p.pose);
        const Move move{body, p.twist};
        return asked.time_of_contact({&move, 1}).time;
      },
      [&](const Placement& p) { return witness.advance(pairs.finger, p.pose, p.twist, 0, stop); },
      [&](const Placement& p) { return sweep.time(pairs.finger, p.pose, retract(p.pose, p.twist)); }};
  std::array<std::vector<double>, methods.size()> times;
  for (const Placement& p : pairs.placements)  // lists grow
    for (const auto& ask : query) ask(p);
  for (const Placement& p : pairs.placements) {
    std::array<double, methods.size()> time;
    for (std::size_t k = 0; k < query.size(); ++k) time[k] = timed(times[k], [&] { return query[k](p); });
    for (std::size_t k = 0; k < query.size(); ++k) {
      const std::string method = methods[k];
      const double here = end_gap(p, time[k]);
      if (time[k] < 1) ++s.hits[method], s.stops[method] += here;
      if (k == 0) s.smallest_gap = std::min(s.smallest_gap, here);
    }
    // Would the whole motion have come within the stop distance? Sampled finely.
    double least = 1;
    for (int k = 0; k <= 20 && least > stop; ++k) least = std::min(least, end_gap(p, k / 20.0));
    s.true_hits += least <= stop;
  }
  for (std::size_t k = 0; k < query.size(); ++k) {
    const std::string method = methods[k];
    s.stops[method] /= std::max(1, s.hits[method]);
    s.times[method] = median(times[k]), s.p95[method] = quantile(times[k], 0.95);
  }
  return s;
}

}  // namespace zwang
