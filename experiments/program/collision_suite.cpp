// The suite of collision queries is a script, experiments/questions/collision.py; here is what it asks the program for.
#include <cstdio>
#include <nlohmann/json.hpp>

#include <zwang/bench/collision/study.h>
#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/scenes/recorded_data.h>
#include <zwang/bench/timing/conditions.h>
#include <zwang/core/files/embedded.h>
#include <zwang/experiments/god_hand/run/hand_study.h>
#include <zwang/experiments/program/commands.h>

ZWANG_EMBEDDED(collision_script, ZWANG_COLLISION)

namespace zwang {

namespace god {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(HandStudy, scene, parts, speed, spin, triangles, pieces, bytes_per_triangle, frames,
                                   median, touching_median, p95, p99, worst, whole_median, whole_p99, touches, manifold,
                                   toc, raw, most_raw, kept, truncations, held, completed, overlaps, gap, body_frames,
                                   touching, audited, penetrations, seconds)
}
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PairStudy, triangles, gap, motion, placements, smallest_gap, true_hits, times, p95,
                                   stops, hits)

// `:pairs TRIANGLES GAP MOTION`: that study. `:hands`: the scenes; `:hands K`: the studies of the K-th, each speed for
// time, then each under audit, then each with friction, twice as long, under audit.
int collision_part(const std::vector<std::string>& words) {
  const std::atomic<bool>& interrupted = stop_on_interrupt();  // ends it between two studies
  const auto say = [](const nlohmann::json& line) { std::printf("%s\n", line.dump().c_str()), std::fflush(stdout); };
  if (words.at(0) == ":pairs") {
    say(study_pairs(std::stoul(words.at(1)), std::stod(words.at(2)), words.at(3), 100));
    return done;
  }
  const std::vector<god::HandScene> scenes = god::hand_scenes(recorded_data());
  if (words.size() == 1) {
    for (const god::HandScene& scene : scenes) say({{"name", scene.name}, {"speeds", scene.speeds}});
    return done;
  }
  const god::HandScene& scene = scenes.at(std::stoul(words[1]));
  const god::Surroundings surroundings = scene.make();
  for (const auto run : {god::HandRun::timed, god::HandRun::audited, god::HandRun::audited_with_friction})
    for (const double speed : scene.speeds) {
      if (interrupted) return stopped;
      say(study_hand(scene, surroundings, speed, run));
    }
  return done;
}

int bench_collision(const std::filesystem::path& directory, const std::string& command) {
  const Conditions c = conditions();
  const nlohmann::json described = {{"version", c.version},   {"commit", c.commit + (c.dirty ? " (changed)" : "")},
                                    {"compiler", c.compiler}, {"flags", c.flags},
                                    {"build", c.build_type},  {"CPU", c.cpu},
                                    {"cores", c.cores},       {"libraries", c.libraries}};
  return continue_as_files({{"collision.py", collision_script()}}, {directory.string(), command}, {described.dump()});
}

}  // namespace zwang
