// Section 7 of the paper in numbers: growth with contacts, clusters of two hands, thinning of contacts, and what it
// costs to model more than the scene needs.

#include <algorithm>
#include <map>

#include <zwang/bench/report/tables/statistics.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/questions/list.h>
#include <zwang/experiments/questions/play.h>

namespace zwang::questions {
namespace {

double in_equations(const god::Frame& f) { return f.times.assembly + f.times.solve; }

// Medians over the frames that have contacts: the others cost the same everywhere.
double median_in_contact(const std::vector<god::Frame>& frames, double (*value)(const god::Frame&)) {
  std::vector<double> values;
  for (const god::Frame& f : frames)
    if (f.kept > 0) values.push_back(value(f));
  return report::median(values);
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
      apart = millimetres(*std::max_element(within.begin(), within.end())) + ", " + millimetres(report::median(within));
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

Findings growth_with_contacts(const Asking& asking) {
  const god::Surroundings scene = god::make_surroundings("simple", asking.parts);
  const auto frames =
      play(scene, motion_for("grasp", scene, asking),
           {.solver = asking.solver, .reduce_contacts = false, .lazy_contacts = false, .verify = 0}, asking, "growth");
  // Medians over quarters of an octave, so that a rare count does not stand for itself.
  std::map<int, std::vector<const god::Frame*>> bins;
  for (const god::Frame& f : frames)
    if (f.kept > 0) bins[static_cast<int>(std::floor(4 * std::log2(f.kept)))].push_back(&f);
  Chart chart{.name = "growth",
              .title = "Assembly and solve against the number of contacts",
              .x = "contacts (rows)",
              .y = "time (us)",
              .kind = Chart::Kind::points,
              .log_x = true,
              .log_y = true};
  std::vector<double> counts, times;
  for (const auto& [bin, members] : bins) {
    if (members.size() < 3) continue;
    std::vector<double> kept, time;
    for (const god::Frame* f : members) kept.push_back(f->kept), time.push_back(in_equations(*f));
    counts.push_back(report::median(kept));
    times.push_back(report::median(time));
    chart.points.push_back({asking.solver, counts.back(), 1e6 * times.back()});
  }
  Findings found{.columns = {"contacts", "assembly and solve"}, .charts = {chart}};
  for (std::size_t k = 0; k < counts.size(); ++k) found.rows.push_back({number(counts[k]), microseconds(times[k])});
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
                                {{"two clusters", {.solver = asking.solver, .verify = 0}},
                                 {"one system", {.solver = asking.solver, .clusters = false, .verify = 0}},
                                 {"nnls, two clusters", {.solver = "nnls", .verify = 0}},
                                 {"nnls, one system", {.solver = "nnls", .clusters = false, .verify = 0}}},
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
      {{"few, completed after each solve", {.solver = asking.solver, .verify = 0}},
       {"all that they may be completed by", {.solver = asking.solver, .lazy_contacts = false, .verify = 0}},
       {"a row for each triangle touched", {.solver = asking.solver, .reduce_contacts = false, .verify = 0}}},
      scene, motion_for("grasp", scene, asking), asking);
}

Findings no_more_than_needed(const Asking& asking) {
  const god::Surroundings scene = god::make_surroundings("simple", asking.parts);
  return side_by_side("model",
                      {{"26 freedoms, contacts thinned and completed", {.solver = asking.solver, .verify = 0}},
                       {"the same with all contacts", {.solver = asking.solver, .lazy_contacts = false, .verify = 0}},
                       {"96 unknowns and 70 joint rows", {.solver = asking.solver, .maximal = true, .verify = 0}},
                       {"96 unknowns, 70 joint rows, all contacts",
                        {.solver = asking.solver, .lazy_contacts = false, .maximal = true, .verify = 0}},
                       {"nnls on 26 freedoms", {.solver = "nnls:reduce=on", .verify = 0}},
                       {"nnls on 96 unknowns and 70 joint rows", {.solver = "nnls", .verify = 0}}},
                      scene, motion_for("grasp", scene, asking), asking);
}

}  // namespace zwang::questions
