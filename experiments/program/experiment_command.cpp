// The questions of the paper are a script, experiments/questions/questions.py; here is what it asks the program for.
// Its parts begin with a colon and answer with a line of JSON each.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/references/reference.h>
#include <zwang/bench/references/witnesses.h>
#include <zwang/bench/report/page/draw.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/scenes/recorded_data.h>
#include <zwang/bench/suite/flow.h>
#include <zwang/bench/suite/suite.h>
#include <zwang/bench/timing/conditions.h>
#include <zwang/collision/world.h>
#include <zwang/core/files/embedded.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/program/commands.h>

ZWANG_EMBEDDED(questions_script, ZWANG_QUESTIONS)
ZWANG_EMBEDDED(hand_script, ZWANG_HAND)

namespace zwang {
namespace {

using nlohmann::json;

void say(const json& line) { std::printf("%s\n", line.dump(-1, ' ', false, json::error_handler_t::replace).c_str()); }

// Through the flow of the suites, from the problem to what the referee says. Nothing when interrupted.
std::optional<Cell> timed(const std::function<Instance()>& assemble, const Run& run, const BatchLimits& limits) {
  static Dispatcher dispatcher;
  std::optional<Cell> cell;
  const auto append = [&cell](const Instance&, std::vector<Cell>& cells) { cell = std::move(cells[0]); };
  run_flow({.assemble = assemble, .runs = {run}, .limits = limits, .append = append}, dispatcher, stop_on_interrupt());
  return cell;
}

// SOLVER TOLERANCE FILES: the seconds of a solve of each, and what the referee says of it.
int times(const std::vector<std::string>& words) {
  const Run run{.solver = words.at(0), .foreign = runs_apart(words[0]), .tolerance = std::stod(words.at(1))};
  for (std::size_t k = 2; k < words.size(); ++k) {
    const auto cell = timed([&] { return read_problems(words[k]).at(0); }, run, {.budget = 0.05});
    if (!cell) return stopped;
    say({{"solve", cell->result.solve_s}, {"verdict", to_string(cell->result.metrics.verdict)}});
  }
  return done;
}

// What an answer z is off a proven solution z* of Coulomb's law: how much faster than there a contact opens (lift) and
// by how much one slips otherwise (creep) [m/s^2], and |z - z*|_M / s.
json price(const Problem& coulomb, const Vector& exact, const Vector& z) {
  double lift = 0, creep = 0;
  const Vector at = coulomb.J * exact - coulomb.c, here = coulomb.J * z - coulomb.c;
  for (Index i = 0; i < coulomb.rows(); ++i) {
    const Index tangents = coulomb.tangents(i);
    if (coulomb.is_equality(i)) continue;
    lift = std::max(lift, here[i] - at[i]);
    creep = std::max(creep, std::abs(here.segment(i + 1, tangents).norm() - at.segment(i + 1, tangents).norm()));
    i += tangents;
  }
  return {{"lift", lift}, {"creep", creep}, {"distance", relative_distance(coulomb, exact, z)}};
}

// SCENES LAW SOLVER LAW SOLVER ...: of each scene what simpler laws cost, `time` in runs of the neutral kernel; nothing
// where Coulomb's law has no proven solution. A scene's laws come one after the other.
int prices(const std::vector<std::string>& words) {
  for (const Instance& scene : make_scenes(words.at(0))) {
    const std::optional<Reference> exact = reference_for(scene, reference_cache(), {}).reference;
    json all = json::array();
    for (std::size_t k = 1; k + 1 < words.size() && exact && exact->feasible; k += 2) {
      const auto cell = timed([&] { return under(parse_law(words[k]), scene); },
                              {.solver = words[k + 1], .tolerance = 1e-10}, {.time_limit = 10, .budget = 0.1});
      if (!cell) return stopped;
      const Vector& z = cell->timed.solution.z;
      if (z.size() != scene.problem.size()) throw std::runtime_error(scene.problem.name + ": no answer");
      json& one = all.emplace_back(price(scene.problem, exact->z, z));
      one["time"] = cell->result.solve_s / cell->result.kernel_s;
      one["verdict"] = to_string(cell->result.metrics.verdict);
    }
    say(all);
  }
  return done;
}

// One body, 100 mm before a wall, its target 50 mm inside: each frame asks for the rest of the way and gets the time of
// contact's share of it. The gaps [m]; `twice`: the share is applied to the velocity and to the step, its square.
int wall(bool twice) {
  constexpr double radius = 0.01;
  collision::World world;
  world.add(collision::Shape::rounded_box({1, 1, 0.1}, 0.001), {}, {.group = 2}, true);
  const int body = world.add(collision::Shape::sphere(radius), {{0, 0, 0.05 + radius + 0.1}, Mat3::Identity()});
  json gaps;
  for (int k = 0; k < 40; ++k) {
    const double gap = world.pose(body).position.z() - 0.05 - radius;
    gaps.push_back(gap);
    Vec<double, 6> way = Vec<double, 6>::Zero();
    way.z() = -(gap + 0.05);
    const double toc = world.time_of_contact(std::array{collision::Move{body, way}}).time;
    world.place(body, retract(world.pose(body), Vec<double, 6>((twice ? toc * toc : toc) * way)));
  }
  say(gaps);
  return done;
}

// Of each row of a hand's J its constraint's type and where it is not 0.
int hand(const std::string& contacts, const std::string& limits) {
  const Instance instance = make_scenes("hand(contacts=" + contacts + ",limits=" + limits + ")")[0];
  const Problem& p = instance.problem;
  json rows;
  for (Index i = 0; i < p.rows(); ++i) {
    json columns = json::array();
    for (Index j = 0; j < p.size(); ++j)
      if (p.J.coeff(i, j) != 0) columns.push_back(j);
    rows.push_back({instance.origin[static_cast<std::size_t>(i)].type, columns});
  }
  say({{"unknowns", p.size()}, {"entries", p.J.nonZeros()}, {"rows", rows}});
  return done;
}

}  // namespace

int hand_command(std::vector<std::string> words) { return continue_as_files({{"hand.py", hand_script()}}, words); }

int experiment_command(std::vector<std::string> words) {
  const std::string part = words.empty() ? "" : words[0];
  const std::vector<std::string> rest(words.begin() + !words.empty(), words.end());
  if (part == ":frames") return frames_part(rest);
  if (part == ":times") return times(rest);
  if (part == ":prices") return prices(rest);
  if (part == ":wall") return wall(rest.at(0) == "twice");
  if (part == ":pairs" || part == ":hands") return collision_part(words);
  if (part == ":hand") return hand(rest.at(0), rest.at(1));
  if (part == ":draw") return report::draw(rest.at(0), rest.at(1)), done;
  const Conditions c = conditions();
  const std::string circumstances =
      "zwang " + c.commit.substr(0, 12) + (c.dirty ? ", changed" : "") + ", " + c.compiler + ", " + c.cpu;
  return continue_as_files({{"questions.py", questions_script()}}, words, {recorded_data().string(), circumstances});
}

}  // namespace zwang
