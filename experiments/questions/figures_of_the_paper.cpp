// Figures 8, 9 and 10 of the paper and the detailed parts of its section 7: what a frame costs, where the time goes.

#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/questions/list.h>
#include <zwang/experiments/questions/play.h>

namespace zwang::questions {
namespace {

Chart frame_times(const std::string& name, const std::string& title, const std::vector<god::Frame>& frames,
                  std::vector<Level> levels) {
  Chart chart{name, title, "time (s)", "time of a frame (ms)"};
  chart.log_y = true;
  chart.levels = std::move(levels);
  add_series(chart, "frame", frames, [](const god::Frame& f) { return 1e3 * f.times.total(); });
  add_series(chart, "collision", frames, [](const god::Frame& f) { return 1e3 * f.times.collision(); });
  return chart;
}

Chart contacts(const std::string& name, const std::string& title, const std::vector<god::Frame>& frames) {
  Chart chart{name, title, "time (s)", "contacts"};
  add_series(chart, "found", frames, [](const god::Frame& f) { return f.raw; });
  add_series(chart, "kept as rows", frames, [](const god::Frame& f) { return f.kept; });
  return chart;
}

std::vector<std::vector<std::string>> rate_rows(const std::vector<god::Frame>& frames, const char* mean,
                                                const char* least, const char* collision) {
  const Rates r = rates(frames);
  const god::Totals all(frames);
  return {{"frames a second, median", number(r.median), ""},
          {"frames a second, mean", number(r.mean), mean},
          {"frames a second, slowest frame", number(r.least), least},
          {"share of collision detection", number(100 * r.collision) + " %", collision},
          {"frames that touch",
           number(100. * static_cast<double>(all.touching()) / static_cast<double>(all.frames())) + " %", ""},
          {"contacts, most in a frame: found, kept", number(all.most("raw")) + ", " + number(all.most("kept")), ""}};
}

struct Played {
  god::Surroundings surroundings;
  std::vector<god::Frame> frames;
};

Played grasp_in(const char* scene, const Asking& asking) {
  Played p;
  p.surroundings = god::make_surroundings(scene, asking.parts);
  p.frames = play(p.surroundings, motion_for("grasp", p.surroundings, asking),
                  {.solver = asking.solver, .mu = 0, .verify = 0}, asking, scene);
  return p;
}

}  // namespace

Findings simple_scene(const Asking& asking) {
  const auto [surroundings, frames] = grasp_in("simple", asking);
  return {.columns = {"simple scene, 100,000 triangles", "here", "paper (2012)"},
          .rows = rate_rows(frames, "600", "100", "about 40 %"),
          .charts = {contacts("fig8-contacts", "Contacts over an interaction, simple scene", frames),
                     frame_times("fig8-times", "Time of a frame over the same interaction", frames,
                                 {{1e3 / 600, "paper, mean"}, {1e3 / 100, "paper, slowest"}})}};
}

Findings stages(const Asking& asking) {
  const auto [surroundings, frames] = grasp_in("simple", asking);
  Findings found{.columns = {"stage, simple scene", "here", "paper (2012)"}};
  Chart chart{"fig9", "Where the time of a frame goes, simple scene", "time (s)", "share of the frame's time",
              Chart::Kind::shares};
  double whole = 0;
  for (const god::Frame& f : frames) whole += f.times.total();
  for (std::size_t k = 0; k < god::stage_names.size(); ++k) {
    double sum = 0;
    for (const god::Frame& f : frames) sum += god::stages(f.times)[k];
    found.rows.push_back({god::stage_names[k], number(100 * sum / whole) + " %",
                          god::stage_names[k] == std::string("collision") ? "about 40 %" : ""});
    // Sums over stretches, so that the shares of a stretch are those of its time.
    const std::size_t stretch = std::max<std::size_t>(1, frames.size() / 200);
    for (std::size_t begin = 0; begin < frames.size(); begin += stretch) {
      double part = 0;
      for (std::size_t i = begin; i < std::min(begin + stretch, frames.size()); ++i)
        part += god::stages(frames[i].times)[k];
      chart.points.push_back({god::stage_names[k], frames[begin].time, part});
    }
  }
  found.charts.push_back(std::move(chart));
  return found;
}

Findings engine(const Asking& asking) {
  const auto [surroundings, frames] = grasp_in("engine", asking);
  return {.columns = {"engine compartment, 1,000,000 triangles", "here", "paper (2012)"},
          .rows = rate_rows(frames, "50 to 70", "below 20", "up to 80 %"),
          .charts = {contacts("fig10-contacts", "Contacts over an interaction, engine compartment", frames),
                     frame_times("fig10-times", "Time of a frame, engine compartment", frames,
                                 {{1e3 / 60, "paper, typical"}, {1e3 / 20, "paper, slow"}})}};
}

Findings detailed_parts(const Asking& asking) {
  const auto [surroundings, frames] = grasp_in("detailed", asking);
  return {.columns = {"parts of 400,000 triangles", "here", "paper (2012)"},
          .rows = rate_rows(frames, "10 to 15", "", "70 to 80 %"),
          .charts = {frame_times("detailed-times", "Time of a frame, parts of 400,000 triangles", frames,
                                 {{1e3 / 12.5, "paper, typical"}})}};
}

}  // namespace zwang::questions
