// What the paper's method does as printed, and what the commit cycle makes of it.

#include <algorithm>

#include <zwang/bench/results/statistics.h>
#include <zwang/collision/world.h>
#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/questions/list.h>
#include <zwang/experiments/questions/play.h>

namespace zwang::questions {

namespace {

struct Method {
  std::string name;
  god::Options options;
};

// The paper's method, then one of its choices after the other replaced until nothing of it is left.
std::vector<Method> from_paper_to_ours(const std::string& solver) {
  using O = god::Options;
  std::vector<Method> all;
  O o = god::paper_method();
  o.verify = 0;
  const auto add = [&](const std::string& name) { all.push_back({name, o}); };
  add("the paper, as printed");
  o.solver = solver;
  add("its solver replaced: " + solver);
  o.toc_twice = o.toc_of_all = false;
  add("and time of contact once");
  o.correct_drift = true;
  add("and c of joints and limits mends their drift");
  o.rows = O::Rows::near;
  add("and contacts near by, with a gap");
  o.reduce_contacts = o.lazy_contacts = true;
  add("and contacts thinned");
  o.bounded = true;
  add("and steps bounded");
  o.sub_steps = O{}.sub_steps;
  add("and three sub-steps");
  o = O{.solver = solver, .mu = 0, .verify = 0};
  o.damped = o.straight = false;
  add("and the commit cycle, limits ahead, 26 unknowns");
  o.damped = o.straight = true;
  add("and damped or straight: zwang's own");
  return all;
}

}  // namespace

Findings separation(const Asking& asking) {
  const god::Surroundings scene = god::make_surroundings("simple", asking.parts);
  const god::HandMotion motion = motion_for("grasp", scene, asking);
  using Commit = god::Options::Commit;
  std::vector<Method> variants = from_paper_to_ours(asking.solver);
  variants.push_back({"zwang's own with the paper's solver", {.solver = "nnls_paper", .mu = 0, .verify = 0}});
  variants.push_back(
      {"zwang's own with the linear step", {.solver = asking.solver, .mu = 0, .commit = Commit::printed, .verify = 0}});
  variants.push_back({"zwang's own with the paper's solver and linear step",
                      {.solver = "nnls_paper", .mu = 0, .commit = Commit::printed, .verify = 0}});
  Findings found{.columns = {"method", "widest gap of a joint", "limits left by", "smallest gap", "from its target",
                             "frames held, stuck", "contacts, most", "frame, median, slowest"}};
  Chart chart{"separation", "Joints of the hand: how far the phalanxes come apart", "time (s)",
              "widest gap of a joint (m)"};
  chart.log_y = true;
  for (const auto& [name, options] : variants) {
    const auto frames = play(scene, motion, options, asking, name);
    const god::Totals all(frames);
    std::vector<double> times;
    for (const god::Frame& f : frames) times.push_back(f.times.total());
    found.rows.push_back(
        {name, number(all.most("joint")) + " m", number(all.most("limit")) + " rad",
         number(1e6 * all.least("gap")) + " um", number(1e3 * all.most("dist")) + " mm",
         number(all.sum("held")) + ", " + number(all.sum("stuck")), number(all.most("kept")),
         number(1e6 * median(times)) + " us, " + number(1e3 * *std::max_element(times.begin(), times.end())) + " ms"});
    add_series(chart, name, frames, [](const god::Frame& f) { return std::max(f.separation, 1e-17); });
  }
  found.charts.push_back(std::move(chart));
  return found;
}

// One body, 100 mm before a wall, its target 50 mm inside: each frame asks for the rest of the way and gets the time of
// contact's share of it. As printed the share is applied to the velocity and to the step: the square of it.
Findings printed_step(const Asking&) {
  Findings found{.columns = {"frame", "gap, TOC once", "gap, TOC twice (as printed)"}};
  Chart chart{"printed-step", "Up to a wall: the time of contact applied once, and twice as printed", "frame",
              "gap (m)"};
  chart.log_y = true;
  constexpr double radius = 0.01;
  constexpr int frames = 40;
  std::vector<double> gaps[2];
  for (const bool twice : {false, true}) {
    collision::World world;
    const int wall = world.add(collision::Shape::rounded_box({1, 1, 0.1}, 0.001), {}, {.group = 2}, true);
    const int body = world.add(collision::Shape::sphere(radius), {{0, 0, 0.05 + radius + 0.1}, Mat3::Identity()});
    for (int k = 0; k < frames; ++k) {
      const double gap = world.pose(body).position.z() - 0.05 - radius;
      gaps[twice].push_back(gap);
      chart.points.push_back({twice ? "TOC twice (Eq. 29-30 as printed)" : "TOC once", 1. * k, gap});
      Vec<double, 6> way = Vec<double, 6>::Zero();
      way.z() = -(gap + 0.05);
      const double toc = world.time_of_contact(std::array{collision::Move{body, way}}).time;
      world.place(body, retract(world.pose(body), Vec<double, 6>((twice ? toc * toc : toc) * way)));
    }
    static_cast<void>(wall);
  }
  for (const int k : {0, 1, 2, 3, 5, 10, 20, frames - 1})
    found.rows.push_back({number(k), number(1e3 * gaps[0][static_cast<std::size_t>(k)]) + " mm",
                          number(1e3 * gaps[1][static_cast<std::size_t>(k)]) + " mm"});
  found.charts.push_back(std::move(chart));
  found.remarks = {"Without contact rows, which would stop the body by themselves: what the printed step does alone."};
  return found;
}

namespace {

Findings swap_solvers(const god::Options& method, const std::string& chart_name, const Asking& asking) {
  const god::Surroundings scene = god::make_surroundings("simple", asking.parts);
  const god::HandMotion motion = motion_for("grasp", scene, asking);
  Findings found{.columns = {"solver", "solve, median", "frames looked at, right", "wrong, undecided", "frames held",
                             "joints", "farthest from the first, first contact second"}};
  Chart chart{chart_name, "One grasp, driven by each solver: speed against what becomes of the motion",
              "farthest from dual_active_set's motion in the first second of contact (m)",
              "time of a frame's solves (us)", Chart::Kind::points};
  chart.log_x = chart.log_y = true;
  std::vector<god::Frame> first;
  for (const char* solver : {"dual_active_set", "nnls", "nnls:reduce=on", "cholesky", "cholesky:reduce=on", "newton",
                             "nnls_paper", "pgs", "apgd", "bullet_dantzig", "bullet_pgs", "nlopt_slsqp", "ipopt"}) {
    god::Options options = method;
    options.solver = solver;
    const std::vector<god::Frame> frames = play(scene, motion, options, asking, solver, 1);
    if (first.empty()) first = frames;
    std::vector<double> times;
    double verified = 0, doubtful = 0;
    for (const god::Frame& f : frames) {
      times.push_back(f.times.solve);
      if (f.verified)
        (f.verified == Verdict::solved || f.verified == Verdict::infeasible_proven ? verified : doubtful)++;
    }
    const god::Totals all(frames);
    const double time = median(times), apart = farthest(first, frames);
    found.rows.push_back({solver, number(1e6 * time) + " us", number(verified), number(doubtful),
                          number(all.sum("held")), number(all.most("joint")) + " m", number(apart) + " m"});
    chart.points.push_back({solver, std::max(apart, 1e-17), 1e6 * time});
  }
  found.charts.push_back(std::move(chart));
  return found;
}

}  // namespace

Findings solver_swap(const Asking& asking) { return swap_solvers({.mu = 0}, "solvers", asking); }
Findings solvers_of_the_paper(const Asking& asking) {
  return swap_solvers(god::paper_method(), "solvers-paper", asking);
}

}  // namespace zwang::questions
