// What the questions of the paper ask of simulated motions: their frames, a line of JSON each.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/god_hand/measure/columns.h>
#include <zwang/experiments/god_hand/measure/disturbance.h>
#include <zwang/experiments/god_hand/tools/play.h>
#include <zwang/experiments/program/choices.h>
#include <zwang/experiments/program/commands.h>

namespace zwang {
namespace {

using nlohmann::json;

json positions(const std::vector<Pose<double>>& poses) {
  json all = json::array();
  for (const Pose<double>& pose : poses) all.push_back({pose.position.x(), pose.position.y(), pose.position.z()});
  return all;
}

json to_json(const god::Frame& frame) {
  json line = {{"stages", god::stages(frame.times)}, {"total", frame.times.total()},
               {"touches", frame.touches()},         {"contacts", frame.contacts.size()},
               {"god", positions(frame.god)},        {"loose", positions(frame.loose)},
               {"target", positions(frame.target)},  {"verified", frame.verified ? to_string(*frame.verified) : ""}};
  for (const god::Column& column : god::columns()) line[column.key] = column.of(frame);
  return line;
}

double farthest(const god::Frame& a, const god::Frame& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.god.size(); ++i) most = std::max(most, (a.god[i].position - b.god[i].position).norm());
  return most;
}

}  // namespace

// The frames of a motion from the first step on. `-- OPTIONS`: each is also made under these, from the same state.
// `withstands`: so many seconds apart, also the largest disturbance that what is held hardest would withstand [N].
// Ends `contact` seconds after the first frame with contacts; the problems of the frames `times` are kept as KEEP/K.h5.
int frames_part(const std::vector<std::string>& words) {
  std::string what, keep;
  double contact = std::numeric_limits<double>::infinity(), seconds = 0, withstands = 0;
  std::vector<long> times;
  const auto record_of_words = [&](std::vector<std::string> of) {
    CLI::App app;
    Choices choices;
    app.add_option("--what", what);
    app.add_option("--contact", contact);
    app.add_option("--withstands", withstands);
    app.add_option("--keep", keep);
    app.add_option("--time", times)->delimiter(',');
    add_choices(app, "experiment", "", choices);
    read(app, std::move(of));
    seconds = choices.seconds;
    return record_of(app, choices, "");
  };
  const auto end = std::ranges::find(words, "--");
  std::optional<god::Options> others;
  if (end != words.end()) others = record_of_words({end + 1, words.end()}).asked.options;
  god::Record record = record_of_words({words.begin(), end});
  const god::Setup setup = god::set_up(record);
  const god::Options& options = record.asked.options;
  god::Play play(setup.surroundings, setup.motion, options);
  std::optional<god::Play> other;
  if (others) other.emplace(setup.surroundings, setup.motion, *others);
  const double length = seconds > 0 ? std::min(seconds, setup.motion.duration) : setup.motion.duration;
  const long count = std::lround(length / options.dt);
  double last = std::numeric_limits<double>::infinity();
  Progress bar;
  for (long k = 1; k <= count; ++k) {
    if (other) other->simulation().restore(play.simulation().checkpoint());
    const god::Frame& frame = play.step(k);
    json line = to_json(frame);
    if (withstands > 0 && frame.grip > 0 && k % std::lround(withstands / options.dt) == 0) {
      const god::Held held = god::held_hardest(frame, setup.surroundings);
      line["withstands"] = god::largest_disturbance(held.contacts, held.weight, options.mu);
    }
    if (other) line["apart"] = farthest(frame, other->step(k));
    std::printf("%s\n", line.dump().c_str());
    if (std::ranges::count(times, k) > 0)
      write_problem(std::filesystem::path(keep) / (std::to_string(k) + ".h5"),
                    {.problem = play.simulation().problem(0), .family = "frames"});
    if (frame.kept > 0) last = std::min(last, frame.time + contact);
    if (frame.time > last) break;
    if (k % 32 == 0) bar.show(static_cast<double>(k) / static_cast<double>(count), what);
    if (stop_on_interrupt()) return stopped;
  }
  return done;
}

}  // namespace zwang
