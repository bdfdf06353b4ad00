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
constexpr double moved = 2;         // factor by which an error moves before it counts
constexpr double dearer = 1.25;     // the same of iterations, which another order of the rows changes by a few

double error(const Result& r) {
  const double e = r.error();
  return std::isfinite(e) ? std::max(e, rounding) : unknown;
}

// A problem's rows in all runs of a side.
struct Side {
  const Result* worst = nullptr;
  double error = unknown, forces = unknown;
  std::vector<double> seconds = {};
  int iterations = 0;
  bool claims = true, handed = false;

  void add(const Result& r) {
    if (!worst || severity(r.metrics.verdict) > severity(worst->metrics.verdict)) worst = &r;
    if (const double e = zwang::error(r); !(e <= error)) error = e;
    if (const double f = std::max({r.metrics.natural, r.metrics.stationarity, rounding}); !(f <= forces)) forces = f;
    if (std::isfinite(r.solve_s)) seconds.push_back(r.solve_s);
    iterations = std::max(iterations, r.iterations);
    claims = claims && (r.claims_solved() || r.claimed == Status::infeasible);
    handed = handed || !r.handed_to.empty();
  }
  bool costs_more_than(const Side& other) const {
    return iterations > dearer * other.iterations && !(other.error > moved * error) && handed == other.handed;
  }
};

std::map<std::string, Side> by_problem(const std::vector<std::vector<Result>>& runs) {
  std::map<std::string, Side> sides;
  for (const auto& run : runs)
    for (const Result& r : run) sides[r.problem_sha256].add(r);
  return sides;
}

Change::Kind kind_of(const Side& before, const Side& after) {
  const Verdict was = before.worst->metrics.verdict, is = after.worst->metrics.verdict;
  const bool was_right = is_right(was), is_now = is_right(is);
  if (is == Verdict::wrong && was != Verdict::wrong) return Change::Kind::newly_wrong;
  const bool far = after.error > told_factor * before.error;
  // An iterate at a limit of sweeps, of which nothing was said, is near or right by chance.
  if (was_right && !is_now && (before.claims || is != Verdict::near || far)) return Change::Kind::newly_unsolved;
  if (was_right && far) return Change::Kind::less_accurate;
  if (was_right && after.forces > std::max(told_factor * before.forces, near_error(after.worst->tolerance)))
    return Change::Kind::wrong_forces;  // rounding of forces grows with them: 2^24 motions between rows nearly parallel
  if (is_now && (!was_right || before.error > told_factor * after.error)) return Change::Kind::better;
  return Change::Kind::same;
}

void count(Drift& drift, bool up, bool down) {
  drift.up += up;
  drift.down += down;
}

constexpr std::array colours{"#c8ccd0", "#2e7d32", "#f0a202",
                             "#8a5a00", "#d96c06", "#b00020"};  // of the kinds, in their order

}  // namespace

std::string_view to_string(Change::Kind kind) {
  constexpr std::array words{"same", "better", "less accurate", "wrong forces", "newly unsolved", "newly wrong"};
  return words[static_cast<std::size_t>(kind)];
}

bool Drift::alarm() const {
  const double n = static_cast<double>(up + down);
  return static_cast<double>(up) - static_cast<double>(down) > sigmas * std::sqrt(n);
}

std::size_t Guarded::count(Change::Kind kind) const {
  return static_cast<std::size_t>(std::ranges::count(changes, kind, &Change::kind));
}

std::size_t Guarded::worse() const { return changes.size() - count(Change::Kind::same) - count(Change::Kind::better); }

const Drift* Guarded::alarm() const {
  const auto found = std::ranges::find_if(drifts, &Drift::alarm);
  return found == drifts.end() ? nullptr : &*found;
}

Guarded compare(const std::vector<std::vector<Result>>& before, const std::vector<std::vector<Result>>& after) {
  const std::map<std::string, Side> old = by_problem(before), now = by_problem(after);
  Guarded all;
  Drift error{"proven error", "larger", "smaller"}, iterations{"iterations", "more", "fewer"},
      claims{"claims of an answer", "lost", "won"}, handed{"answers of another solver", "more", "fewer"},
      time{"time", "slower", "faster"};
  std::vector<double> ratios;
  for (const Result& first : before.at(0)) {
    const Side &a = old.at(first.problem_sha256), &b = now.at(first.problem_sha256);
    Change& change = all.changes.emplace_back(
        Change{first.problem, kind_of(a, b), a.worst->metrics.verdict, b.worst->metrics.verdict, a.error, b.error});
    if (change.kind == Change::Kind::wrong_forces) change.error_before = a.forces, change.error_after = b.forces;
    if (!is_right(change.before) || !is_right(change.after)) continue;
    count(error, b.error > moved * a.error, a.error > moved * b.error);
    count(iterations, b.costs_more_than(a), a.costs_more_than(b));
    count(claims, a.claims && !b.claims, b.claims && !a.claims);
    count(handed, b.handed && !a.handed, a.handed && !b.handed);
    if (before.size() < 2 || after.size() < 2 || a.seconds.size() != before.size() || b.seconds.size() != after.size())
      continue;
    count(time, std::ranges::min(b.seconds) > std::ranges::max(a.seconds),
          std::ranges::max(b.seconds) < std::ranges::min(a.seconds));
    ratios.push_back(median(b.seconds) / median(a.seconds));
  }
  if (!ratios.empty()) time.what += " x " + printed("%.2f", median(std::move(ratios)));
  all.drifts = {error, iterations, claims, handed, time};
  return all;
}

std::string describe(const Guarded& g, std::size_t most) {
  std::string text;
  for (std::size_t k = colours.size(); k-- > 0;) {
    const auto kind = static_cast<Change::Kind>(k);
    text += grouped(g.count(kind)) + " " + std::string(to_string(kind)) + (k > 0 ? ", " : "\n");
  }
  for (const Drift& d : g.drifts)
    text += d.what == "time" ? "time: not compared, which takes two runs or more a side\n"
                             : d.what + ": " + d.worse + " on " + grouped(d.up) + ", " + d.better + " on " +
                                   grouped(d.down) + (d.alarm() ? "   more than chance\n" : "\n");
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
  constexpr std::size_t columns = 32, side = 22;
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
    x += 30 + 6 * label.size();
  }
  return svg + "</svg>\n";
}

std::string to_badge(const Guarded& g) {
  const std::string said = !g.is_worse()   ? "no worse"
                           : g.worse() > 0 ? grouped(g.worse()) + " worse"
                                           : g.alarm()->what + ": " + g.alarm()->worse;
  const std::size_t width = 110 + 7 * said.size();
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + std::to_string(width) +
         "\" height=\"20\" font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"96\" height=\"20\" "
         "fill=\"#444444\"/><rect x=\"96\" width=\"" +
         std::to_string(width - 96) + "\" height=\"20\" fill=\"" + (g.is_worse() ? colours.back() : colours[1]) +
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
  for (const Drift& d : g.drifts)
    cases.push_back({"guard", d.what.substr(0, d.what.find(" x ")) + " over the pack",
                     d.alarm() ? d.worse + " on more problems than chance explains" : ""});
  return junit(cases);
}

}  // namespace zwang
