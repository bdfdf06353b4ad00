#include <zwang/bench/collision/study.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>

#include <zwang/bench/collision/bullet_sweep.h>
#include <zwang/bench/collision/hand_shapes.h>
#include <zwang/bench/collision/meshes.h>
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

HandStudy study_hand(const HandScene& scene, const HandScene::Start& start, double speed, HandRun run) {
  HandStudy s{.scene = scene.name, .parts = scene.parts, .speed = speed, .spin = scene.spin};
  const auto begin = std::chrono::steady_clock::now();
  const bool audited = run != HandRun::timed, friction = run == HandRun::audited_with_friction;
  const std::unique_ptr<MovingHand> hand = start(speed, friction);
  const std::vector<Shape>& shapes = hand->shapes();

  // Bodies and obstacles in a world of their own, for gaps that do not come from the hand itself.
  World world;
  for (const Shape& shape : shapes) world.add(shape, {}, {1, 2});
  for (const Obstacle& obstacle : hand->obstacles())
    std::visit(
        [&](const auto& body) {
          if constexpr (std::is_same_v<decltype(body), const Shape&>)
            world.add(body, {}, {2, 1}, true);
          else {
            world.add(body, {}, {2, 1});
            s.triangles += body->size();
            s.bytes_per_triangle += body->bytes_per_triangle() * static_cast<double>(body->size());
          }
        },
        obstacle);
  s.bytes_per_triangle /= static_cast<double>(std::max<std::size_t>(1, s.triangles));
  s.pieces = hand->obstacles().size();

  Audit audit({shapes}, audited ? hand->obstacles() : std::vector<Obstacle>());
  std::vector<Pose<double>> between(shapes.size());
  if (audited)
    hand->watch([&](std::span<const Pose<double>> from, std::span<const Pose<double>> to) {
      double jumps = 1;
      for (std::size_t b = 0; b < shapes.size(); ++b) {
        const Vec<double, 6> twist = twist_between(from[b], to[b]);
        const double way = twist.head<3>().norm() + twist.tail<3>().norm() * shapes[b].reach();
        jumps = std::max(jumps, std::ceil(way / shapes[b].radius()));
      }
      for (double k = 1; k <= jumps; ++k) {
        for (std::size_t b = 0; b < shapes.size(); ++b)
          between[b] = k == jumps ? to[b] : retract(from[b], Vec<double, 6>(k / jumps * twist_between(from[b], to[b])));
        audit.check(between, hand->obstacle_poses());
      }
    });

  std::vector<double> times, touching, whole;
  for (int i = 0; i < (friction ? 2 : 1) * scene.frames; ++i) {
    const HandFrame f = hand->step();
    if (i < 20) continue;  // lists grow
    for (std::size_t b = 0; b < shapes.size(); ++b) world.place(static_cast<int>(b), hand->poses()[b]);
    for (std::size_t k = 0; k < s.pieces; ++k)
      world.place(static_cast<int>(shapes.size() + k), hand->obstacle_poses()[k]);
    double gap = 1;
    std::vector<bool> touches(shapes.size());
    for (const collision::Touch& t : world.touches(hand::touching)) {
      gap = std::min(gap, t.gap);
      touches[static_cast<std::size_t>(t.a)] = true;
    }
    const auto bodies = std::count(touches.begin(), touches.end(), true);
    times.push_back(f.collision());
    whole.push_back(f.whole);
    if (bodies > 0) touching.push_back(f.collision());
    s.touches += f.search, s.manifold += f.completion, s.toc += f.sweep;
    s.raw += f.raw, s.kept += f.kept;
    s.most_raw = std::max(s.most_raw, static_cast<double>(f.raw));
    s.truncations += std::max(0, f.sub_steps - 1), s.held += f.held, s.completed += f.completed;
    s.overlaps += gap <= 0;
    s.gap = std::min(s.gap, gap);
    s.body_frames += static_cast<long>(shapes.size());
    s.touching += bodies;
  }
  s.audited = audit.checked(), s.penetrations = audit.found();
  s.frames = static_cast<int>(times.size());
  for (double* mean : {&s.touches, &s.manifold, &s.toc, &s.raw, &s.kept}) *mean /= s.frames;
  s.median = median(times), s.p95 = quantile(times, 0.95), s.p99 = quantile(times, 0.99);
  s.worst = quantile(times, 1), s.touching_median = touching.empty() ? 0 : median(touching);
  s.whole_median = median(whole), s.whole_p99 = quantile(whole, 0.99);
  s.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return s;
}

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
