// write_replay DIR [FRAMES]: the replay page of a run that nobody simulated: a hand dips into rolling ground beside
// loose objects. With a wrong, a stuck, a held and an untracked frame. For the test in the browser.
#include <cmath>
#include <cstdlib>
#include <iostream>

#include <zwang/experiments/god_hand/run/frame_store.h>
#include <zwang/experiments/god_hand/run/replay.h>

using namespace zwang;
using namespace zwang::god;

namespace {

double ground(double x, double y) {
  const double r = std::hypot(x, y);
  return 0.012 * std::sin(14 * x) * std::cos(11 * y) + 0.002 * std::sin(61 * x + 3 * y) +
         0.08 * std::exp(-std::pow((r - 0.5) / 0.08, 2));
}

std::shared_ptr<const collision::Tree> ground_tree(int n) {
  collision::Mesh mesh;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = 1.1 * (i / (n - 1.0) - 0.5), y = 1.1 * (j / (n - 1.0) - 0.5);
      mesh.vertices.push_back({x, y, ground(x, y)});
    }
  for (std::uint32_t j = 0; j + 1 < static_cast<std::uint32_t>(n); ++j)
    for (std::uint32_t i = 0; i + 1 < static_cast<std::uint32_t>(n); ++i) {
      const std::uint32_t m = static_cast<std::uint32_t>(n), v = j * m + i;
      mesh.triangles.push_back({v, v + 1, v + m});
      mesh.triangles.push_back({v + 1, v + m + 1, v + m});
    }
  return std::make_shared<const collision::Tree>(mesh);
}

Surroundings surroundings() {
  const auto at = [](double x, double y, double z) { return Pose<double>{{x, y, z}, Mat3::Identity()}; };
  using collision::Shape;
  const std::vector<Vec3> wedge = {{-0.03, -0.03, -0.02}, {0.03, -0.03, -0.02}, {-0.03, 0.03, -0.02},
                                   {0.03, 0.03, -0.02},   {-0.03, 0, 0.03},     {0.03, 0, 0.03}};
  Surroundings s;
  s.name = "ground";
  s.objects = {{.name = "ground", .mesh = ground_tree(320)},
               {.name = "block", .pieces = {{Shape::rounded_box({0.3, 0.02, 0.1}, 0.002)}}, .pose = at(0, 0.2, 0.05)},
               {.name = "box",
                .pieces = {{Shape::rounded_box({0.05, 0.06, 0.04}, 0.003)}},
                .pose = at(0.15, 0, 0.03),
                .mass = 0.2},
               {.name = "wedge", .pieces = {{Shape::hull(wedge, 0.002)}}, .pose = at(-0.16, 0.05, 0.03), .mass = 0.1},
               {.name = "dumbbell",
                .pieces = {{Shape::capsule(0.06, 0.008)},
                           {Shape::sphere(0.02), at(0, 0.03, 0)},
                           {Shape::sphere(0.02), at(0, -0.03, 0)}},
                .pose = at(0.13, -0.13, 0.03),
                .mass = 0.1}};
  return s;
}

// The target sinks by up to 30 mm, the hand does not.
Frame frame_at(long k, double dt, const Surroundings& about) {
  Frame f;
  f.number = k;
  f.time = static_cast<double>(k + 1) * dt;
  const double phase = 0.5 - 0.5 * std::cos(2 * f.time), sink = 0.03 * std::max(0.0, phase - 0.4);
  hand::Angles bent = {}, open = {};
  for (std::size_t i = 0; i < bent.size(); ++i) {
    if (i % 4 == 1) continue;
    bent[i] = 0.25 + 0.5 * phase;
    open[i] = 0.25 + 0.3 * phase;
  }
  const Vec3 palm(0.05 * std::sin(f.time), -0.06, 0.09 - 0.03 * phase);
  const hand::Poses target = hand::forward_kinematics({palm - sink * Vec3::UnitZ(), Mat3::Identity()}, bent);
  const hand::Poses god = hand::forward_kinematics({palm, Mat3::Identity()}, open);
  f.target.assign(target.begin(), target.end());
  f.god.assign(god.begin(), god.end());
  for (const Object& object : about.objects)
    if (object.loose()) f.loose.push_back(retract(object.pose, Vec<double, 6>(0.02 * phase, 0, 0, 0, 0, f.time)));
  if (sink > 0)
    for (int finger = 0; finger < 5; ++finger) {
      const int tip = 3 + 3 * finger;
      const Vec3 point = god[static_cast<std::size_t>(tip)] * Vec3(0, 0.01, -0.008);
      f.contacts.push_back({tip, 0, point, Vec3(0.1, 0.1, 1).normalized(), 2e-4, 400 * sink});
    }
  f.gap = sink > 0 ? 2e-4 : 0.02;
  f.target_depth = sink;
  f.separation = 3e-13;
  f.distance = sink + 0.001;
  f.rows = 70 + static_cast<int>(f.contacts.size());
  f.raw = static_cast<int>(8 * f.contacts.size());
  f.kept = static_cast<int>(f.contacts.size());
  f.sub_steps = 1;
  f.palm_wrench = Vec<double, 6>::Constant(300 * sink);
  f.claimed = Status::solved;
  f.verified = Verdict::solved;
  const double busy = 1 + static_cast<double>(f.kept) / 3 + 0.2 * std::sin(91.0 * f.time);
  f.times = {.physics = 4e-5 * busy,
             .resolution = 1e-6,
             .assembly = 1e-5 * busy,
             .solve = 3e-5 * busy,
             .search = 8e-5 * busy,
             .other = 5e-6};
  f.held = k == 60;
  f.stuck = k == 90;
  f.tracked = k < 20 || k > 30;
  if (k == 120) {
    f.gap = -0.001;
    f.contacts.front().gap = -0.001;
  }
  if (k == 150) f.verified = Verdict::wrong;
  return f;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) return 2;
  const std::filesystem::path directory = argv[1];
  const long frames = argc > 2 ? std::atol(argv[2]) : 300;
  std::filesystem::create_directories(directory);
  const Surroundings about = surroundings();
  Record record{.command = "./zwang simulate ground --motion dip", .started = "2026-11-21T08:00:00Z"};
  record.asked = {.scene = "ground", .motion = "dip", .frames = frames};
  record.asked.options.dt = 0.01;
  record.title = "dip";
  record.hands = 1;
  record.bodies = hand::bodies;
  record.loose = 3;
  write_record(directory, record);
  FrameWriter writer(directory, hand::bodies, record.loose);
  Summary summary;
  ShownFrames shown(frames);
  for (long k = 0; k < frames; ++k) {
    const Frame frame = frame_at(k, record.asked.options.dt, about);
    writer.write(frame);
    summary.add(frame);
    shown.add(frame);
  }
  writer.flush();
  const std::array gods = {ShownGod{"hand", false, hand::shapes(hand::standard())}};
  std::cout << write_replay(directory, record, summary, shown.frames(), about, gods).string() << "\n";
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 2;
}
