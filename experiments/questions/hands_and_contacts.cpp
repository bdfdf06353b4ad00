// Section 7 of the paper in numbers: growth with contacts, clusters of two hands, thinning of contacts, and what it
// costs to model more than the scene needs.

#include <algorithm>
#include <cmath>
#include <map>

#include <zwang/bench/report/tables/statistics.h>
#include <zwang/bench/suite/flow.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/god_hand/tools/play.h>
#include <zwang/experiments/questions/list.h>
#include <zwang/experiments/questions/play.h>
#include <zwang/solvers/registry.h>

namespace zwang::questions {
namespace {

double in_equations(const god::Frame& f) { return f.times.assembly + f.times.solve; }

// Medians over the frames that have contacts: the others cost the same everywhere.
double median_in_contact(const std::vector<god::Frame>& frames, double (*value)(const god::Frame&)) {
  std::vector<double> values;
  for (const god::Frame& f : frames)
    if (f.kept > 0) values.push_back(value(f));
  return median(values);
}

std::string microseconds(double seconds) { return number(1e6 * seconds) + " us"; }

struct Variant {
  std::string name;
  god::Options options;
};

std::string millimetres(double metres) { return number(1e3 * metres) + " mm"; }

// The same motion under several options, beside the first one's: frame by frame from the first one's state, where the
// options have the same states (clusters), and as a whole. Whole motions that differ by rounding once part at the next
// frame in which a finger may slip or not; only the first figure compares the forms.
Findings side_by_side(const std::string& first_column, const std::vector<Variant>& variants,
                      const god::Surroundings& surroundings, const god::HandMotion& motion, const Asking& asking) {
  Findings found{.columns = {first_column, "assembly and solve", "whole frame", "rows", "contacts found, kept",
                             "apart within a frame (largest, median)", "over the whole motion"}};
  std::vector<god::Frame> first;
  for (const Variant& v : variants) {
    std::vector<god::Frame> frames = play(surroundings, motion, v.options, asking, v.name);
    const auto of = [&](double (*value)(const god::Frame&)) { return median_in_contact(frames, value); };
    if (first.empty()) first = frames;
    std::string apart;
    if (&v != &variants.front() && v.options.clusters == variants.front().options.clusters) {
      const std::vector<double> within =
          apart_within_frames(surroundings, motion, variants.front().options, v.options, asking, v.name);
      apart = millimetres(*std::max_element(within.begin(), within.end())) + ", " + millimetres(median(within));
    }
    found.rows.push_back({v.name, microseconds(of(in_equations)),
                          microseconds(of([](const god::Frame& f) { return f.times.total(); })),
                          number(of([](const god::Frame& f) { return 1. * f.rows; })),
                          number(of([](const god::Frame& f) { return 1. * f.raw; })) + ", " +
                              number(of([](const god::Frame& f) { return 1. * f.kept; })),
                          apart, millimetres(farthest(first, frames))});
  }
  found.remarks = {
      "Times, rows and contacts: medians over the frames with contacts. Apart: the farthest that a god object is from "
      "the same one of the first line; within a frame: both from the first line's state, in every frame."};
  return found;
}

}  // namespace

// Every touch a row. The problems that come up in a grasp, in bins of a quarter of an octave of their contacts, so that
// a rare count does not stand for itself; some of each bin are timed apart from the simulation, as the suites time
// theirs.
Findings growth_with_contacts(const Asking& asking) {
  const god::Surroundings scene = god::make_surroundings("simple", asking.parts);
  const god::HandMotion motion = motion_for("grasp", scene, asking);
  const god::Options options{
      .solver = asking.solver, .mu = 0, .reduce_contacts = false, .lazy_contacts = false, .verify = 0};
  constexpr std::size_t sampled = 5;
  struct Bin {
    std::vector<double> contacts, assembly;  // s, of all frames
    std::vector<Problem> problems;           // of every `stride`-th
    std::size_t stride = 1;
  };
  std::map<int, Bin> bins;
  god::Play play(scene, motion, options);
  each_frame(motion, options.dt, asking, "growth", [&](long k) {
    const god::Frame& f = play.step(k);
    if (f.contacts.empty()) return true;
    Bin& bin = bins[static_cast<int>(std::floor(4 * std::log2(f.contacts.size())))];
    if (bin.contacts.size() % bin.stride == 0) bin.problems.push_back(play.simulation().problem(0));
    if (bin.problems.size() == 2 * sampled) {
      for (std::size_t s = 0; s < sampled; ++s) bin.problems[s] = bin.problems[2 * s];
      bin.problems.resize(sampled);
      bin.stride *= 2;
    }
    bin.contacts.push_back(static_cast<double>(f.contacts.size()));
    bin.assembly.push_back(f.times.assembly);
    return true;
  });

  Findings found{.columns = {"contacts", "assembly, in a frame", "solve", "verified"}};
  Chart chart{"growth", "Assembly and solve against the number of contacts", "contacts (rows)", "time (us)",
              Chart::Kind::points};
  chart.log_x = chart.log_y = true;
  std::vector<double> counts, times;
  Dispatcher dispatcher([](std::string_view solver) { return make_solver(solver); });
  const Run run{.solver = asking.solver, .foreign = runs_apart(asking.solver), .tolerance = options.tolerance};
  const std::atomic<bool> never = false;
  for (const auto& [number_of_bin, bin] : bins) {
    std::vector<double> solves;
    std::map<std::string_view, int> verdicts;
    const auto append = [&](const Instance&, std::vector<Cell>& cells) {
      solves.push_back(cells[0].result.solve_s);
      ++verdicts[to_string(cells[0].result.metrics.verdict)];
    };
    for (const Problem& problem : bin.problems)
      if (!run_flow({.assemble = [&] { return Instance{.problem = problem, .family = "growth"}; },
                     .runs = {run},
                     .limits = {.budget = 0.05},
                     .append = append},
                    dispatcher, asking.interrupted ? *asking.interrupted : never))
        throw Interrupted{};
    counts.push_back(median(bin.contacts));
    times.push_back(median(bin.assembly) + median(solves));
    chart.points.push_back({asking.solver, counts.back(), 1e6 * times.back()});
    std::string verified;
    for (const auto& [verdict, n] : verdicts)
      verified += (verified.empty() ? "" : ", ") + std::to_string(n) + " " + std::string(verdict);
    found.rows.push_back(
        {number(counts.back()), microseconds(median(bin.assembly)), microseconds(median(solves)), verified});
  }
  found.charts.push_back(std::move(chart));
  if (counts.size() >= 3) {
    const report::PowerLaw law = report::fit_power_law(counts, times);
    found.remarks.push_back("Fitted exponent over all counts: " + number(law.exponent) + " +- " + number(law.error, 2) +
                            " (the paper: 1, 'a linear relationship'; a constant part for the joints pulls it down).");
  }
  return found;
}

Findings two_hands(const Asking& asking) {
  const god::Surroundings scene = god::make_surroundings("simple", asking.parts);
  const god::HandMotion motion = motion_for("two_hands", scene, asking);
  Findings found = side_by_side("two hands",
                                {{"two clusters", {.solver = asking.solver, .mu = 0, .verify = 0}},
                                 {"one system", {.solver = asking.solver, .mu = 0, .clusters = false, .verify = 0}},
                                 {"nnls, two clusters", {.solver = "nnls", .mu = 0, .verify = 0}},
                                 {"nnls, one system", {.solver = "nnls", .mu = 0, .clusters = false, .verify = 0}}},
                                scene, motion, asking);
  found.remarks.push_back(
      "The paper: clusters make computing the accelerations faster by a factor of about 1.7; that is assembly and "
      "solve.");
  return found;
}

Findings thinning(const Asking& asking) {
  const god::Surroundings scene = god::make_surroundings("simple", asking.parts);
  return side_by_side(
      "contacts",
      {{"few, completed after each solve", {.solver = asking.solver, .mu = 0, .verify = 0}},
       {"all that they may be completed by", {.solver = asking.solver, .mu = 0, .lazy_contacts = false, .verify = 0}},
       {"a row for each triangle touched", {.solver = asking.solver, .mu = 0, .reduce_contacts = false, .verify = 0}}},
      scene, motion_for("grasp", scene, asking), asking);
}

Findings no_more_than_needed(const Asking& asking) {
  const god::Surroundings scene = god::make_surroundings("simple", asking.parts);
  return side_by_side(
      "model",
      {{"26 freedoms, contacts thinned and completed", {.solver = asking.solver, .mu = 0, .verify = 0}},
       {"the same with all contacts", {.solver = asking.solver, .mu = 0, .lazy_contacts = false, .verify = 0}},
       {"96 unknowns and 70 joint rows", {.solver = asking.solver, .mu = 0, .maximal = true, .verify = 0}},
       {"96 unknowns, 70 joint rows, all contacts",
        {.solver = asking.solver, .mu = 0, .lazy_contacts = false, .maximal = true, .verify = 0}},
       {"nnls on 26 freedoms", {.solver = "nnls:reduce=on", .mu = 0, .verify = 0}},
       {"nnls on 96 unknowns and 70 joint rows", {.solver = "nnls", .mu = 0, .verify = 0}}},
      scene, motion_for("grasp", scene, asking), asking);
}

}  // namespace zwang::questions
