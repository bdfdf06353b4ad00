// What a hand does to things, and things to a hand: friction that is not there, pushes at several rates, recordings.

#include <algorithm>

#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/questions/list.h>
#include <zwang/experiments/questions/play.h>

namespace zwang::questions {

Findings artificial_friction(const Asking& asking) {
  const god::Surroundings scene = god::make_surroundings("wall", asking.parts);
  const auto frames =
      play(scene, motion_for("slide", scene, asking), {.solver = asking.solver, .mu = 0, .verify = 0}, asking, "slide");
  double lost = 0, way = 0;
  for (std::size_t k = 1; k < frames.size(); ++k) {
    if (!frames[k].touches()) continue;
    lost = std::max(lost, frames[k].lost_slide);
    way += (frames[k].target[0].position - frames[k - 1].target[0].position).norm();
  }
  Findings found{.columns = {"sliding on a frictionless plane", "here", "paper (2012)"}};
  found.rows = {{"way of the pressed hand's target", number(way) + " m", ""},
                {"farthest that the hand lags along the plane", number(lost) + " m", ""},
                {"share of the way", number(lost / way), "artificial friction does not occur"}};
  Chart chart{"friction", "How far a pressed hand lags behind its target along a frictionless plane", "time (s)",
              "distance (m)"};
  chart.log_y = true;
  add_series(chart, "of the centre of mass", frames, [](const god::Frame& f) { return std::max(f.lost_slide, 1e-20); });
  found.charts.push_back(std::move(chart));
  return found;
}

// The palm, upright, goes 0.25 m along x at 0.4 m/s: from 60 mm before the first loose object to behind it.
static god::HandMotion push_at(const god::Surroundings& scene) {
  const auto box =
      std::find_if(scene.objects.begin(), scene.objects.end(), [](const god::Object& o) { return o.loose(); });
  if (box == scene.objects.end()) throw std::invalid_argument(scene.name + " has no loose object to push");
  Mat3 upright;
  upright << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  god::Track hand{.model = hand::standard()};
  const Vec3 start = box->pose.position - Vec3(0.06 + 0.014 + box->pieces[0].shape.half().x(), 0, 0);
  constexpr double speed = 0.4, way = 0.25;
  hand.keys.push_back({0, {{start, upright}, {}, true}});
  hand.keys.push_back({way / speed, {{start + Vec3(way, 0, 0), upright}, {}, true}});
  hand.keys.push_back({way / speed + 0.5, {{start + Vec3(way, 0, 0), upright}, {}, true}});
  hand.patience = 1;
  return {"push", {hand}, way / speed + 0.5};
}

Findings rate_of_a_push(const Asking& asking) {
  const god::Surroundings scene = god::make_surroundings("box", asking.parts);
  const god::HandMotion motion = push_at(scene);
  Findings found{.columns = {"rate", "box moved", "fastest", "fastest against the hand", "worst balance of impulses"}};
  Chart chart{"rates", "One push of a box at three rates", "time (s)", "way of the box (m)"};
  for (const double rate : {250., 500., 1000.}) {
    const std::string name = number(rate) + " Hz";
    const auto frames =
        play(scene, motion, {.dt = 1 / rate, .solver = asking.solver, .mu = 0, .verify = 0}, asking, name);
    const god::Totals all(frames);
    const double fastest = all.most("speed");
    const Vec3 start = frames.front().loose[0].position;
    const double moved = (frames.back().loose[0].position - start).norm();
    found.rows.push_back({name, number(1e3 * moved, 4) + " mm", number(fastest) + " m/s", number(fastest / 0.4),
                          number(all.most("impulse"))});
    add_series(chart, name, frames, [&](const god::Frame& f) { return (f.loose[0].position - start).norm(); });
  }
  found.charts.push_back(std::move(chart));
  return found;
}

Findings recordings(const Asking& asking) {
  Findings found{.columns = {"recording, scene", "frames", "that touch", "target deepest inside", "smallest gap",
                             "joints", "limits left by", "held", "stuck", "median rate", "slowest"}};
  std::vector<std::filesystem::path> files;
  if (std::filesystem::exists(asking.data / "motion_leap_bones"))
    for (const auto& entry : std::filesystem::directory_iterator(asking.data / "motion_leap_bones"))
      if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) found.remarks.push_back("There are no recordings in " + asking.data.string() + ".");
  for (const auto& file : files)
    for (const char* name : {"simple", "engine"}) {
      const god::Surroundings scene = god::make_surroundings(name, asking.parts);
      god::HandMotion motion = god::read_motion(file);
      god::place(motion, scene);
      const auto frames =
          play(scene, motion, {.solver = asking.solver, .mu = 0, .verify = 0}, asking, file.stem().string());
      const god::Totals all(frames);
      const Rates r = rates(frames);
      found.rows.push_back({file.stem().string() + ", " + name, number(static_cast<double>(all.frames())),
                            number(static_cast<double>(all.touching())), number(1e3 * all.most("depth")) + " mm",
                            number(1e6 * all.least("gap")) + " um", number(all.most("joint")) + " m",
                            number(all.most("limit")) + " rad", number(all.sum("held")), number(all.sum("stuck")),
                            number(r.median) + " Hz", number(r.least) + " Hz"});
    }
  return found;
}

}  // namespace zwang::questions
