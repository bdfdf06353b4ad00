#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/results/statistics.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/experiments/god_hand/motion/motions.h>
#include <zwang/experiments/god_hand/play.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/god_hand/stream/stream.h>
#include <zwang/experiments/program/commands.h>

namespace zwang {

// The loop at the pace of the clock. Targets come from the motion until a client sends some.
int live_command(std::vector<std::string> words) {
  CLI::App app("Runs the god hand in real time: poses in, poses, forces and contacts out, over a UNIX socket.");
  introduce(app, "live",
            "  ./zwang live box --socket /tmp/hand\n"
            "  ./zwang live simple --socket /tmp/hand --motion two_hands --rate 500 --seconds 60\n\n"
            "The layout of the messages, and a reader of them: docs/stream.md.\n");
  std::string scene = "simple", socket, motion_name = "grasp";
  double rate = 1000, seconds = 0;
  app.add_option("SCENE", scene, "as in ./zwang simulate; default: simple")->type_name("");
  app.add_option("--socket", socket, "where clients connect to")->required()->type_name("PATH");
  app.add_option("--motion", motion_name, "what the hands do until a client sends poses; default: grasp")
      ->type_name("FILE|NAME");
  app.add_option("--rate", rate, "frames a second; default: 1000")->check(from_to(1.0, 1e4))->type_name("HZ");
  app.add_option("--seconds", seconds, "stop after so much simulated time; default: at Ctrl-C")->check(above(0));
  if (!read(app, std::move(words))) return done;

  const god::Surroundings surroundings = god::make_surroundings(scene, "");
  const bool recorded = god::names_file(motion_name);
  god::HandMotion motion = recorded ? god::read_motion(motion_name) : god::synthetic_motion(motion_name, surroundings);
  if (recorded) god::place(motion, surroundings);
  const god::Options options{.dt = 1 / rate, .verify = 0};
  god::Play play(surroundings, motion, options);
  std::vector<Pose<double>> targets;
  const std::size_t bodies = play.simulation().shapes().size();
  god::Stream stream(socket, bodies, [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); });
  std::printf("%zu god objects in %s at %s Hz; clients connect to %s; Ctrl-C ends it\n", bodies, scene.c_str(),
              grouped(static_cast<std::size_t>(rate)).c_str(), socket.c_str());
  std::fflush(stdout);

  using Clock = std::chrono::steady_clock;
  const auto step = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.dt));
  const std::atomic<bool>& interrupted = stop_on_interrupt();
  const long most = seconds > 0 ? std::max(1l, std::lround(seconds * rate)) : std::numeric_limits<long>::max();
  auto due = Clock::now();
  long frames = 0, late = 0;
  bool live = false;
  for (; frames < most && !interrupted; ++frames) {
    live = stream.receive(targets) || live;
    stream.send(live ? play.simulation().step(targets) : play.step(frames));
    due += step;
    const auto now = Clock::now();
    if (now <= due) {
      std::this_thread::sleep_until(due);
      continue;
    }
    ++late;
    if (now - due > std::chrono::milliseconds(100)) due = now;  // what is lost is not caught up with
  }
  std::printf("%s frames, %s of them not in time, %ld that a reader had no room for\n",
              grouped(static_cast<std::size_t>(frames)).c_str(), grouped(static_cast<std::size_t>(late)).c_str(),
              stream.missed());
  return done;
}

}  // namespace zwang
