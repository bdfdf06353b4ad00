#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <thread>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/program/options.h>
#include <zwang/core/problem/wording.h>
#include <zwang/experiments/god_hand/measure/step_cost.h>
#include <zwang/experiments/god_hand/stream/stream.h>
#include <zwang/experiments/god_hand/tools/play.h>
#include <zwang/experiments/program/choices.h>
#include <zwang/experiments/program/commands.h>

namespace zwang {
namespace {

using Clock = std::chrono::steady_clock;

// Frames that were not in time, by what made them late.
struct Late {
  long slow = 0;    // the step took more CPU time than there is
  long behind = 0;  // a cheap one after another late one, whose delay was not made up yet
  long waited = 0;  // a cheap one in time for its beginning: the processor was elsewhere
  long all() const { return slow + behind + waited; }
};

}  // namespace

// The loop at the pace of the clock. Targets come from the motion until a client sends some.
int live_command(std::vector<std::string> words) {
  CLI::App app("Runs the god hand in real time: poses in, poses, forces and contacts out, over a socket.");
  Choices choices;
  god::Stream::Place place;
  app.add_option("--socket", place.socket, "a local socket that clients connect to")->type_name("PATH");
  app.add_option("--listen", place.address,
                 "TCP, beside it or instead; without HOST for this machine alone; port 0: one that is free. Whoever "
                 "reaches HOST may move the hand")
      ->type_name("[HOST:]PORT");
  add_choices(app, "live",
              "  ./zwang live box --socket /tmp/hand\n"
              "  ./zwang live box --listen 4567\n"
              "  ./zwang live simple --socket /tmp/hand --motion two_hands --rate 500 --seconds 60\n"
              "  ./zwang live hole --listen 4567 --god peg --motion insert --mu 0\n"
              "The hands follow --motion until a client sends poses. Messages, and programs that read and send them:\n"
              "docs/stream.md.\n",
              choices);
  app.remove_option(app.get_option("--verify"));  // the referee would take the time of many steps
  const std::string command = command_line("live", words);
  if (!read(app, std::move(words))) return done;
  if (place.socket.empty() && place.address.empty())
    throw std::invalid_argument("where do clients connect to? --socket PATH or --listen PORT (./zwang live --help)");

  god::Record record = record_of(app, choices, command);
  record.asked.options.verify = 0;
  record.asked.options.measured = false;  // nor would the measures of a record, as long as a step
  const god::Setup setup = god::set_up(record);
  god::Play play(setup.surroundings, setup.motion, record.asked.options, setup.tool ? &*setup.tool : nullptr);
  god::Stream stream(place, record.bodies, [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); });
  std::printf("%s\n%s; clients connect to %s; Ctrl-C ends it\n", head_line(record, setup).c_str(),
              counted(record.bodies, "god object").c_str(), stream.where().c_str());
  std::fflush(stdout);

  const double dt = record.asked.options.dt;
  const auto step = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(dt));
  const std::atomic<bool>& interrupted = stop_on_interrupt();
  const long most = choices.seconds > 0 ? frames_of(choices) : std::numeric_limits<long>::max();
  auto due = Clock::now();
  long frames = 0;
  bool live = false, was_late = false;
  Late late;
  god::StepCost cost(at(std::min(most, 1l << 20)));
  std::vector<Pose<double>> targets;
  for (; frames < most && !interrupted; ++frames) {
    live = stream.receive(targets) || live;
    const god::Frame& frame = live ? play.simulation().step(targets) : play.step(frames);
    stream.send(frame);
    cost.add(frame.times);
    due += step;
    const auto now = Clock::now();
    if (now > due) ++(frame.times.total() > dt ? late.slow : was_late ? late.behind : late.waited);
    was_late = now > due;
    if (now <= due) std::this_thread::sleep_until(due);
    if (now - due > std::chrono::milliseconds(100)) due = now;  // what is lost is not caught up with
  }
  std::printf("%s at %s Hz, %s late: %s took longer than %s, %s came after a late one, for %s the processor was busy\n",
              counted(frames, "frame").c_str(), grouped(std::lround(choices.rate)).c_str(), grouped(late.all()).c_str(),
              grouped(late.slow).c_str(), god::milliseconds(dt).c_str(), grouped(late.behind).c_str(),
              grouped(late.waited).c_str());
  std::printf("%s (CPU); %s that a reader had no room for\n", cost.line().c_str(),
              counted(stream.missed(), "frame").c_str());
  return done;
}

}  // namespace zwang
