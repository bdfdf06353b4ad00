// What a simpler law of friction costs: lift, creep, distance and time of the pyramid, the cone and Coulomb's law.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include <zwang/bench/references/reference.h>
#include <zwang/bench/references/witnesses.h>
#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/suite/flow.h>
#include <zwang/bench/suite/suite.h>
#include <zwang/core/problem/law.h>
#include <zwang/experiments/questions/list.h>
#include <zwang/experiments/questions/play.h>

namespace zwang::questions {
namespace {

// A law, and a solver that is exact under it.
struct Reading {
  const char* name;
  Law law;
  const char* solver;
};
constexpr std::array readings{Reading{"pyramid", Law::pyramid, "dual_active_set"},
                              Reading{"convex", Law::convex, "cone"}, Reading{"Coulomb", Law::coulomb, "cone"}};

// Of one reading on one scene, against a proven solution z* of Coulomb's law.
struct Price {
  double lift = 0;      // m/s^2: how much faster than at z* a contact opens
  double creep = 0;     // m/s^2: by how much a contact slips otherwise than at z*
  double distance = 0;  // |z - z*|_M / s
  double time = 0;      // runs of the neutral kernel
  bool right = false;   // under the law itself
};

Price price(const Problem& coulomb, const Vector& exact, const Vector& z) {
  Price out{.distance = relative_distance(coulomb, exact, z)};
  const Vector at = coulomb.J * exact - coulomb.c, here = coulomb.J * z - coulomb.c;
  for (Index i = 0; i < coulomb.rows(); ++i) {
    const Index tangents = coulomb.tangents(i);
    if (coulomb.is_equality(i)) continue;
    out.lift = std::max(out.lift, here[i] - at[i]);
    out.creep =
        std::max(out.creep, std::abs(here.segment(i + 1, tangents).norm() - at.segment(i + 1, tangents).norm()));
    i += tangents;
  }
  return out;
}

struct Sweep {
  const char* name;
  const char* axis;
  std::vector<std::pair<double, std::string>> scenes;  // x and the scene, all seeds
};

std::string text(double value) { return number(value, 6); }

std::vector<Sweep> sweeps() {
  Sweep by_mu{"mu", "mu, boxes pushed with up to half their weight", {}};
  Sweep by_push{"push", "largest push (weights), mu = 1/4", {}};
  for (const double mu : {0.03125, 0.0625, 0.125, 0.25, 0.5, 1., 2.})
    by_mu.scenes.emplace_back(mu, "stack(boxes=3,push=0.5,seed=1..3,mu=" + text(mu) + ")");
  for (const double push : {0.0625, 0.125, 0.25, 0.5, 1., 2., 4.})
    by_push.scenes.emplace_back(push, "stack(boxes=3,mu=0.25,seed=1..3,push=" + text(push) + ")");
  return {by_mu, by_push};
}

// All readings of one scene, interleaved. Empty where Coulomb's law has no proven solution.
std::vector<Price> prices(const Instance& scene, Dispatcher& desk, const Asking& asking) {
  const std::optional<Reference> exact = reference_for(scene, reference_cache(), {}).reference;
  if (!exact || !exact->feasible) return {};
  static const std::atomic<bool> never = false;
  std::vector<Price> all;
  for (const Reading& reading : readings) {
    const auto append = [&](const Instance&, std::vector<Cell>& cells) {
      const Vector& z = cells[0].timed.solution.z;
      if (z.size() != scene.problem.size()) throw std::runtime_error(scene.problem.name + ": no answer");
      Price& p = all.emplace_back(price(scene.problem, exact->z, z));
      const Result& r = cells[0].result;
      p.time = r.solve_s / r.kernel_s;
      p.right = r.metrics.verdict == Verdict::solved || r.metrics.verdict == Verdict::consistent;
    };
    if (!run_flow({.assemble = [&] { return under(reading.law, scene); },
                   .runs = {{.solver = reading.solver, .tolerance = 1e-10}},
                   .limits = {.time_limit = 10, .budget = 0.1},
                   .append = append},
                  desk, asking.interrupted ? *asking.interrupted : never))
      throw Interrupted{};
  }
  return all;
}

double median_of(const std::vector<Price>& all, double Price::*field) {
  std::vector<double> values;
  for (const Price& p : all) values.push_back(p.*field);
  return median(values);
}

struct Measure {
  const char* name;
  const char* axis;
  double Price::*field;
};
constexpr std::array measures{
    Measure{"lift", "lift (m/s^2)", &Price::lift}, Measure{"creep", "creep (m/s^2)", &Price::creep},
    Measure{"distance", "|z - z*| / s (1)", &Price::distance}, Measure{"time", "time (neutral kernels)", &Price::time}};
// Below, differences are those of the reference's rounding.
constexpr double least_shown = 1e-9;

std::string paragraph(const std::map<std::string, std::vector<Price>>& all, std::size_t scenes, std::size_t left_out) {
  const auto most = [&](const char* name, double Price::*field) {
    double value = 0;
    for (const Price& p : all.at(name)) value = std::max(value, p.*field);
    return number(value, 2);
  };
  const auto time = [&](const char* name) { return number(median_of(all.at(name), &Price::time), 2); };
  const auto right = std::ranges::count_if(all.at("Coulomb"), &Price::right);
  return "On " + std::to_string(scenes) + " stacks of three boxes (12 contacts; mu from 1/32 to 2, pushes up to four " +
         "weights) the convex law is off a proven solution of Coulomb's law by up to " +
         most("convex", &Price::distance) + " of the motion, the pyramid of four facets by up to " +
         most("pyramid", &Price::distance) + "; contacts that slide open by up to " + most("convex", &Price::lift) +
         " and " + most("pyramid", &Price::lift) + " m/s^2 where they should stay closed, and slip by up to " +
         most("convex", &Price::creep) + " and " + most("pyramid", &Price::creep) +
         " m/s^2 otherwise. Where nothing slides all laws agree. Median times are " + time("pyramid") + " (pyramid), " +
         time("convex") + " (convex) and " + time("Coulomb") +
         " (Coulomb) neutral kernels; Coulomb's answers are proven or consistent on " + std::to_string(right) + " of " +
         std::to_string(scenes) + "." +
         (left_out == 0
              ? ""
              : " On " + std::to_string(left_out) + " more stacks no solution was proven; they are left out.");
}

}  // namespace

Findings laws_of_friction(const Asking& asking) {
  Findings found{.columns = {"scene", "law", "solver", "right", "lift (m/s^2)", "creep (m/s^2)", "|z - z*| / s",
                             "time (kernels)"}};
  std::map<std::string, std::vector<Price>> all;
  std::size_t scenes = 0, left_out = 0;
  Dispatcher desk([](std::string_view solver) { return make_solver(solver); });
  std::vector<Chart> charts;
  for (const Measure& measure : measures)
    for (const Sweep& sweep : sweeps()) {
      Chart& chart = charts.emplace_back(Chart{std::string("laws-") + measure.name + "-" + sweep.name,
                                               "What a simpler law of friction costs: pyramid, cone and Coulomb's law",
                                               sweep.axis, measure.axis, Chart::Kind::points});
      chart.figure = "laws";
      chart.log_x = chart.log_y = true;
    }
  std::size_t column = 0;
  for (const Sweep& sweep : sweeps()) {
    for (const auto& [x, spec] : sweep.scenes) {
      std::map<std::string, std::vector<Price>> here;
      for (const Instance& scene : make_scenes(spec)) {
        const std::vector<Price> of_scene = prices(scene, desk, asking);
        if (of_scene.empty()) {
          ++left_out;
          continue;
        }
        ++scenes;
        for (std::size_t k = 0; k < readings.size(); ++k) here[readings[k].name].push_back(of_scene[k]);
      }
      for (const Reading& reading : readings) {
        const std::vector<Price>& own = here[reading.name];
        if (own.empty()) continue;
        all[reading.name].insert(all[reading.name].end(), own.begin(), own.end());
        std::vector<std::string> row = {
            spec, reading.name, reading.solver,
            std::to_string(std::ranges::count_if(own, &Price::right)) + " of " + std::to_string(own.size())};
        for (std::size_t m = 0; m < measures.size(); ++m) {
          const double value = median_of(own, measures[m].field);
          row.push_back(number(value));
          if (value >= least_shown) charts[2 * m + column].points.push_back({reading.name, x, value});
        }
        found.rows.push_back(std::move(row));
      }
    }
    ++column;
  }
  found.charts = std::move(charts);
  if (scenes > 0) found.remarks.push_back(paragraph(all, scenes, left_out));
  return found;
}

}  // namespace zwang::questions
