#include <zwang/bench/packs/guard.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <zwang/bench/packs/xml.h>
#include <zwang/bench/results/statistics.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

// An error that grew more than this, from above rounding, is told by the problem's name. Harmless changes (other flags,
// another order of the rows) move errors of rounding by one or two digits.
constexpr double told_factor = 1000;
constexpr double rounding = 1e-13;  // relative errors below are equal
constexpr double drifts = 2;        // factor by which an error moves before it counts

bool is_wrong(const Result& r) { return r.metrics.verdict == Verdict::wrong; }

double error(const Result& r) {
  const double e = r.error();
  return std::isfinite(e) ? std::max(e, rounding) : unknown;
}

// A problem's rows in all runs of a side.
struct Side {
  const Result* worst = nullptr;
  double error = unknown;
  std::vector<double> seconds = {};
  int iterations = 0;

  void add(const Result& r) {
    if (!worst || severity(r.metrics.verdict) > severity(worst->metrics.verdict)) worst = &r;
    if (const double e = zwang::error(r); !(e <= error)) error = e;
    if (std::isfinite(r.solve_s)) seconds.push_back(r.solve_s);
    iterations = std::max(iterations, r.iterations);
  }
};

std::map<std::string, Side> by_problem(const std::vector<std::vector<Result>>& runs) {
  std::map<std::string, Side> sides;
  for (const auto& run : runs)
    for (const Result& r : run) sides[r.problem_sha256].add(r);
  return sides;
}

Change::Kind kind_of(const Side& before, const Side& after) {
  const bool was_right = is_right(before.worst->metrics.verdict), is_now = is_right(after.worst->metrics.verdict);
  if (is_wrong(*after.worst) && !is_wrong(*before.worst)) return Change::Kind::newly_wrong;
  if (was_right && !is_now) return Change::Kind::newly_unsolved;
  if (!was_right && is_now) return Change::Kind::better;
  if (was_right && after.error > told_factor * before.error) return Change::Kind::less_accurate;
  if (was_right && before.error > told_factor * after.error) return Change::Kind::better;
  return Change::Kind::same;
}

void count(Drift& drift, bool up, bool down) {
  drift.up += up;
  drift.down += down;
}

constexpr std::array colours{"#c8ccd0", "#2e7d32", "#f0a202", "#d96c06", "#b00020"};  // of the kinds, in their order

}  // namespace

std::string_view to_string(Change::Kind kind) {
  switch (kind) {
    case Change::Kind::same:
      return "same";
    case Change::Kind::better:
      return "better";
    case Change::Kind::less_accurate:
      return "less accurate";
    case Change::Kind::newly_unsolved:
      return "newly unsolved";
    case Change::Kind::newly_wrong:
      return "newly wrong";
  }
  return "";
}

bool Drift::alarm() const {
  const double n = static_cast<double>(up + down);
  return static_cast<double>(up) - static_cast<double>(down) > sigmas * std::sqrt(n);
}

std::size_t Guarded::count(Change::Kind kind) const {
  return static_cast<std::size_t>(std::ranges::count(changes, kind, &Change::kind));
}

bool Guarded::alarm() const {
  return count(Change::Kind::newly_wrong) + count(Change::Kind::newly_unsolved) + count(Change::Kind::less_accurate) >
             0 ||
         error.alarm() || time.alarm();
}

Guarded compare(const std::vector<std::vector<Result>>& before, const std::vector<std::vector<Result>>& after) {
  const std::map<std::string, Side> old = by_problem(before), now = by_problem(after);
  Guarded all;
  all.timed = before.size() > 1 && after.size() > 1;
  std::vector<double> ratios;
  for (const Result& first : before.at(0)) {
    const Side &a = old.at(first.problem_sha256), &b = now.at(first.problem_sha256);
    all.changes.push_back(
        {first.problem, kind_of(a, b), a.worst->metrics.verdict, b.worst->metrics.verdict, a.error, b.error});
    if (!is_right(all.changes.back().before) || !is_right(all.changes.back().after)) continue;
    count(all.error, b.error > drifts * a.error, a.error > drifts * b.error);
    count(all.iterations, b.iterations > a.iterations, b.iterations < a.iterations);
    if (!all.timed || a.seconds.size() != before.size() || b.seconds.size() != after.size()) continue;
    count(all.time, std::ranges::min(b.seconds) > std::ranges::max(a.seconds),
          std::ranges::max(b.seconds) < std::ranges::min(a.seconds));
    ratios.push_back(median(b.seconds) / median(a.seconds));
  }
  if (!ratios.empty()) all.time_ratio = median(std::move(ratios));
  return all;
}

std::string describe(const Guarded& g, std::size_t most) {
  std::string text;
  for (const auto kind : {Change::Kind::newly_wrong, Change::Kind::newly_unsolved, Change::Kind::less_accurate,
                          Change::Kind::better, Change::Kind::same})
    text += (text.empty() ? "" : ", ") + grouped(g.count(kind)) + " " + std::string(to_string(kind));
  text += "\n";
  const auto drift = [&](const char* what, const char* up, const char* down, const Drift& d) {
    text += std::string(what) + ": " + up + " on " + grouped(d.up) + ", " + down + " on " + grouped(d.down) +
            (d.alarm() ? "   more than chance\n" : "\n");
  };
  drift("proven error", "larger", "smaller", g.error);
  drift("iterations", "more", "fewer", g.iterations);
  if (g.timed)
    drift(("time x " + printed("%.2f", g.time_ratio)).c_str(), "slower", "faster", g.time);
  else
    text += "time: not compared, which takes two runs or more a side\n";
  for (const Change& c : g.changes) {
    if (c.kind == Change::Kind::same || c.kind == Change::Kind::better) continue;
    if (most-- == 0) return text + "...\n";
    text += std::string(to_string(c.kind)) + ": " + c.problem + "   " + std::string(to_string(c.before)) + " -> " +
            std::string(to_string(c.after)) + ", error " + printed("%.1e", c.error_before) + " -> " +
            printed("%.1e", c.error_after) + "\n";
  }
  return text;
}

std::string to_map(const Guarded& g) {
  constexpr std::size_t columns = 25, side = 22;
  const std::size_t rows = (g.changes.size() + columns - 1) / columns, height = rows * side + 44;
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + std::to_string(columns * side + 20) +
                    "\" height=\"" + std::to_string(height) +
                    "\" font-family=\"sans-serif\" font-size=\"12\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  for (std::size_t k = 0; k < g.changes.size(); ++k) {
    const Change& c = g.changes[k];
    svg += "<rect x=\"" + std::to_string(10 + k % columns * side) + "\" y=\"" +
           std::to_string(10 + k / columns * side) + "\" width=\"20\" height=\"20\" rx=\"3\" fill=\"" +
           colours[static_cast<std::size_t>(c.kind)] + "\"><title>" +
           in_xml(c.problem + ": " + std::string(to_string(c.before)) + " -> " + std::string(to_string(c.after))) +
           "</title></rect>\n";
  }
  std::size_t x = 10;
  for (std::size_t k = 0; k < colours.size(); ++k) {
    const std::string label =
        grouped(g.count(static_cast<Change::Kind>(k))) + " " + std::string(to_string(static_cast<Change::Kind>(k)));
    svg += "<rect x=\"" + std::to_string(x) + "\" y=\"" + std::to_string(height - 24) +
           "\" width=\"12\" height=\"12\" fill=\"" + colours[k] + "\"/><text x=\"" + std::to_string(x + 16) +
           "\" y=\"" + std::to_string(height - 14) + "\">" + label + "</text>\n";
    x += 30 + 7 * label.size();
  }
  return svg + "</svg>\n";
}

std::string to_badge(const Guarded& g) {
  const std::size_t worse = g.changes.size() - g.count(Change::Kind::same) - g.count(Change::Kind::better);
  const std::string said = !g.alarm()        ? "no worse"
                           : worse > 0       ? grouped(worse) + " worse"
                           : g.error.alarm() ? "less accurate"
                                             : "slower";
  const std::size_t width = 110 + 7 * said.size();
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + std::to_string(width) +
         "\" height=\"20\" font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"96\" height=\"20\" "
         "fill=\"#444444\"/><rect x=\"96\" width=\"" +
         std::to_string(width - 96) + "\" height=\"20\" fill=\"" + (g.alarm() ? colours.back() : colours[1]) +
         "\"/>\n<text x=\"8\" y=\"14\" fill=\"#ffffff\">contact guard</text><text x=\"103\" y=\"14\" "
         "fill=\"#ffffff\">" +
         said + "</text>\n</svg>\n";
}

std::string to_junit(const Guarded& g) {
  std::vector<XmlCase> cases;
  for (const Change& c : g.changes)
    cases.push_back({"guard", c.problem,
                     c.kind == Change::Kind::same || c.kind == Change::Kind::better
                         ? ""
                         : std::string(to_string(c.kind)) + ": " + std::string(to_string(c.before)) + " -> " +
                               std::string(to_string(c.after))});
  cases.push_back({"guard", "accuracy over the pack",
                   g.error.alarm() ? "proven errors grew on more problems than chance explains" : ""});
  cases.push_back(
      {"guard", "time over the pack", g.time.alarm() ? "slower on more problems than chance explains" : ""});
  return junit(cases);
}

}  // namespace zwang
