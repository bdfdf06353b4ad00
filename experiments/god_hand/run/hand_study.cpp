#include <zwang/experiments/god_hand/run/hand_study.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include <zwang/bench/collision/audit.h>
#include <zwang/bench/collision/meshes.h>
#include <zwang/bench/results/statistics.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/collision/world.h>
#include <zwang/experiments/god_hand/scenes/scene_objects.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/god_hand/scenes/site.h>
#include <zwang/experiments/god_hand/simulation.h>

namespace zwang::god {
namespace {

using collision::Shape;
using collision::World;
using std::numbers::pi;

// Fingers bent to a share of their range, the thumb to a part of that.
hand::Angles bent(double share, double thumb, double time, double wave) {
  hand::Angles angles{};
  for (int k = 0; k < hand::angles; ++k) {
    const double pulse = 0.5 - 0.5 * std::cos(2 * pi * (0.7 + 0.05 * k) * time);
    if (k % 4 != 1) angles[at(k)] = share * (1 - wave + wave * pulse) * (k < 4 ? thumb : 1) * hand::range(k).high;
  }
  return angles;
}

// How far a course with these amplitudes [m] is on at a time [rad]: its mean speed is about `speed`.
double phase(double time, double speed, double along, double across) {
  return speed * time / std::hypot(along, 0.7 * across);
}

// From above down to 15 mm below the surface at the focus, then on a Lissajous figure along it, the fingers curling and
// stretching. spin: rad a frame of 1 ms, of the palm about its normal, to and fro.
Course stroke(const Surroundings& surroundings, double reach, double spin) {
  return [site = std::make_shared<const Site>(surroundings), reach, spin](double time, double speed) {
    const double lowered = std::min(1.0, time / 0.15), at = phase(time, speed, reach, reach);
    Pose<double> palm = site->flat(0.05 - 0.065 * lowered, reach * std::sin(at), reach * std::sin(0.7 * at));
    const double turn = 0.4 * std::sin(0.3 * at) + (spin > 0 ? std::sin(spin * time / 1e-3) : 0);
    palm.rotation = rotation(turn * site->out) * palm.rotation;
    return Target{palm, bent(0.25, 1, time, 1)};
  };
}

// The hand closed about a bar of 0.1 m along x, its top at z = 0, deeper than the bar lets it, and dragged along it: 13
// of 16 bodies are pressed on something, on a flat surface it is the palm and the finger tips.
Target grip(double time, double speed) {
  constexpr double reach = 0.18;  // m
  const double closed = std::min(1.0, time / 0.15), at = phase(time, speed, reach, 0);
  const double half = hand::standard().palm_widths.z() / 2;
  const Pose<double> palm{{reach * std::sin(at), -0.045, half - 0.03 * closed + 0.05 * (1 - closed)},
                          rotation(0.1 * std::sin(0.3 * at) * Vec3::UnitZ()) * rotation(Vec3(-0.5, 0, 0))};
  return {palm, bent(0.6 * closed, 0.3, time, 0.1)};
}

// A scene of its own: one mesh.
Surroundings alone(const std::string& name, const collision::Mesh& mesh) {
  return {.name = name, .objects = {fixed(name, tree_of(mesh), Vec3::Zero())}};
}

// A bar along x, 0.1 m thick, its top at z = 0. `outline` [m]: radius at an angle about x and a place along it.
Surroundings bar(const std::string& name, collision::Mesh along_z,
                 const std::function<double(double angle, double x)>& outline) {
  for (Vec3& p : along_z.vertices) {
    const double angle = std::atan2(p.y(), p.x()), share = std::hypot(p.x(), p.y()) / 0.05;
    const double radius = share * outline(angle, p.z());
    p = {p.z(), radius * std::cos(angle), radius * std::sin(angle) - 0.05};
  }
  return alone(name, along_z);
}

// A sheet rolled up, without thickness.
Surroundings tube() {
  collision::Mesh mesh = meshes::sheet(0.6, 2 * pi * 0.05, 30000);
  for (Vec3& p : mesh.vertices) p = {p.x(), 0.05 * std::sin(p.y() / 0.05), 0.05 * std::cos(p.y() / 0.05) - 0.05};
  return alone("tube", mesh);
}

}  // namespace

std::vector<HandScene> hand_scenes(const std::filesystem::path& data) {
  const bool real =
      std::filesystem::exists(data / "mesh_differential") && std::filesystem::exists(data / "mesh_factory_parts");
  const std::filesystem::path parts = real ? data : std::filesystem::path();
  std::vector<HandScene> scenes;
  const auto add = [&](std::string name, std::string of, std::vector<double> speeds, int frames,
                       std::function<Surroundings()> make, std::function<Course(const Surroundings&)> course,
                       double spin = 0) {
    scenes.push_back(
        {std::move(name), std::move(of), std::move(speeds), frames, std::move(make), std::move(course), spin});
  };
  const auto named = [](const char* scene, std::filesystem::path from = {}) {
    return [=] { return make_surroundings(scene, from); };
  };
  const auto stroking = [](double reach, double spin = 0) {
    return [=](const Surroundings& s) { return stroke(s, reach, spin); };
  };
  const auto gripping = [](const Surroundings&) { return grip; };

  add("100k triangles, 5 parts", real ? "real: a differential" : "procedural", {0.5, 1, 2}, 1000,
      named("simple", parts), stroking(0.06));
  add("1M triangles, 20 parts", real ? "real: differentials, gears, bolts, counter tops" : "procedural", {0.5, 1, 2},
      1500, named("engine", parts), stroking(0.12));
  if (real)
    add("1M triangles, 20 procedural parts", "an engine compartment", {0.5}, 1000, named("engine"), stroking(0.12));
  add("three parts of 400k triangles", "gear, perforated plate, bumpy sphere", {0.5, 2}, 1000, named("detailed"),
      stroking(0.08));
  add("wall", "20k triangles, flat", {0.5, 2}, 800, named("wall"), stroking(0.12));
  add("sheet without thickness", "20k triangles", {1, 5}, 1200, named("plate"), stroking(0.12));
  add(
      "slivers", "20k triangles of 1 : 3000", {0.5, 5}, 800,
      [] { return alone("slivers", meshes::slivers(0.3, 0.01, 20000)); }, stroking(0.1));
  add("plate with holes", "64k triangles", {1, 5}, 500, named("holes"), stroking(0.12));
  add("turning 0.5 rad a frame", "the five parts of 100k triangles", {1}, 500, named("simple", parts),
      stroking(0.06, 0.5), 0.5);
  add("loose objects", "dumbbell, mug, T, box, can and ball on a table", {0.5, 2}, 800, named("grasp"), stroking(0.15));
  add(
      "gripped pipe", "100k triangles, smooth", {0.5, 2}, 2500,
      [] { return bar("pipe", meshes::pipe(0.05, 0.01, 0.6, 100000), [](double, double) { return 0.05; }); }, gripping);
  add(
      "gripped bumpy bar", "60k triangles", {0.5, 2}, 2500,
      [] {
        return bar("bumpy bar", meshes::pipe(0.05, 0.01, 0.6, 60000),
                   [](double angle, double x) { return 0.05 * (1 + 0.05 * std::sin(6 * angle) * std::sin(120 * x)); });
      },
      gripping);
  add(
      "gripped shaft with teeth", "100k triangles", {0.5, 2}, 2500,
      [] { return bar("shaft", meshes::gear(0.05, 0.6, 30, 100000), [](double, double) { return 0.05; }); }, gripping);
  add("gripped tube of a sheet without thickness", "30k triangles", {1, 5}, 2500, tube, gripping);
  return scenes;
}

HandStudy study_hand(const HandScene& scene, const Surroundings& surroundings, double speed, HandRun run) {
  HandStudy s{.scene = scene.name, .parts = scene.parts, .speed = speed, .spin = scene.spin};
  const auto begin = std::chrono::steady_clock::now();
  const bool audited = run != HandRun::timed, friction = run == HandRun::audited_with_friction;
  const Options options{.mu = friction ? Options().mu : 0, .verify = 0};
  const Course course = scene.course(surroundings);
  Target target = course(0, speed);
  Simulation simulation(surroundings, std::span(&hand::standard(), 1), std::span(&target, 1), options);
  const std::vector<Shape> shapes = simulation.shapes();
  const std::vector<MetPart> parts = met_parts(surroundings);
  for (const MetPart& part : parts)
    if (const auto* tree = std::get_if<std::shared_ptr<const collision::Tree>>(&part.body)) {
      s.triangles += (*tree)->size();
      s.bytes_per_triangle += (*tree)->bytes_per_triangle() * static_cast<double>((*tree)->size());
    }
  s.bytes_per_triangle /= static_cast<double>(std::max<std::size_t>(1, s.triangles));
  s.pieces = parts.size();

  // Bodies and objects in a world of their own, for gaps that do not come from the hand itself.
  World world;
  for (const Shape& shape : shapes) world.add(shape, {}, {1, 2});
  const Scenery scenery(world, surroundings, [](const Object&) { return Scenery::Role{{2, 1}}; });

  std::vector<Obstacle> obstacles;
  for (const MetPart& part : parts)
    if (audited) obstacles.push_back(part.body);
  Audit audit({shapes}, obstacles);
  std::vector<Pose<double>> between(shapes.size());
  if (audited)
    simulation.watch([&](std::size_t, PoseSpan from, PoseSpan to) {
      const std::vector<Pose<double>> others = met_poses(parts, simulation.object_poses());
      double jumps = 1;
      for (std::size_t b = 0; b < shapes.size(); ++b) {
        const Vec<double, 6> twist = twist_between(from[b], to[b]);
        const double way = twist.head<3>().norm() + twist.tail<3>().norm() * shapes[b].reach();
        jumps = std::max(jumps, std::ceil(way / shapes[b].radius()));
      }
      for (double k = 1; k <= jumps; ++k) {
        for (std::size_t b = 0; b < shapes.size(); ++b)
          between[b] = k == jumps ? to[b] : retract(from[b], Vec<double, 6>(k / jumps * twist_between(from[b], to[b])));
        audit.check(between, others);
      }
    });

  std::vector<double> times, touching, whole;
  for (int i = 0; i < (friction ? 2 : 1) * scene.frames; ++i) {
    target = course(static_cast<double>(i + 1) * options.dt, speed);
    const Frame& f = simulation.step(std::span(&target, 1));
    if (i < 20) continue;  // lists grow
    for (std::size_t b = 0; b < shapes.size(); ++b) world.place(static_cast<int>(b), f.god[b]);
    for (std::size_t o = 0; o < surroundings.objects.size(); ++o) scenery.place(world, o, simulation.object_poses()[o]);
    double gap = 1;
    std::vector<bool> touches(shapes.size());
    for (const collision::Touch& t : world.touches(hand::touching)) {
      gap = std::min(gap, t.gap);
      touches[at(t.a)] = true;
    }
    const auto bodies = std::count(touches.begin(), touches.end(), true);
    times.push_back(f.times.collision());
    whole.push_back(f.times.total());
    if (bodies > 0) touching.push_back(f.times.collision());
    s.touches += f.times.search, s.manifold += f.times.completion, s.toc += f.times.sweep;
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

}  // namespace zwang::god
