#include <zwang/bench/report/page/page.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string_view>

#include <zwang/bench/report/tables/accuracy.h>
#include <zwang/bench/report/tables/cells.h>
#include <zwang/bench/report/tables/sweeps.h>
#include <zwang/bench/report/wording.h>
#include <zwang/core/files/embedded.h>

// The pages, which bundle.mjs makes of templates, libraries and chart specs, are part of the program: writing a report
// needs neither Node nor a file beside it.
ZWANG_EMBEDDED(report_html, ZWANG_REPORT_PAGE)
ZWANG_EMBEDDED(collision_html, ZWANG_COLLISION_PAGE)
ZWANG_EMBEDDED(league_html, ZWANG_LEAGUE_PAGE)

namespace zwang::report {
namespace {

using nlohmann::json;

std::string handed_over(const RunFolder& run) {
  std::vector<std::string> parts;
  for (const auto& [names, problems] : run.handed_over)
    parts.push_back(names.first + " to " + names.second + " on " + counted(problems.size(), "problem"));
  return parts.empty() ? "" : "Handed over, and counted for the solver that answered alone: " + joined(parts) + ".";
}

// What a reader must know to compare fairly, beside the run's own notes.
std::vector<std::string> notes(const RunFolder& run) {
  const auto any = [&run](const char* part) {
    return std::ranges::any_of(run.solvers, [part](const auto& s) { return s.name.find(part) != std::string::npos; });
  };
  std::vector<std::string> out = run.notes;
  if (run.is_large())
    out.push_back(
        "A run of this size is drawn by its medians; of runs drawn alone at most 20 of a family, solver and "
        "kind are shown. Counts, tables and profiles are of all runs; single ones are below.");
  if (any("slsqp") && any("nnls"))
    out.push_back(
        "NLopt's SLSQP contains the Lawson-Hanson NNLS kernel: nnls against SLSQP is in part one method against "
        "itself.");
  out.push_back("Times are thread CPU times; BLAS runs on one thread.");
  if (any("cholesky")) out.push_back("CHOLMOD's modify and supernodal modules are under the GPL.");
  if (std::ranges::any_of(run.results, [](const auto& r) { return r.reference.find("CGAL") != std::string::npos; }))
    out.push_back("CGAL's QP solver, a witness of references, is under the GPL.");
  return out;
}

json to_json(const Table& table, std::size_t most_rows) {
  json columns = json::array(), rows = json::array();
  for (const Column& c : table.columns) columns.push_back({{"name", c.name}, {"numeric", c.numeric}});
  for (const Row& row : table.rows) {
    if (rows.size() == most_rows) break;
    json cells = json::array();
    for (const Cell& cell : row.cells) {
      json c = {{"text", cell.text}};
      if (std::isfinite(cell.value)) c["value"] = cell.value;
      if (!cell.tone.empty()) c["tone"] = cell.tone;
      cells.push_back(c);
    }
    json r = {{"solver", row.solver}, {"group", row.group}, {"cells", cells}};
    if (!row.command.empty()) r["command"] = row.command;
    rows.push_back(r);
  }
  std::string note = table.note;
  if (table.rows.size() > most_rows)
    note += " The first " + counted(most_rows, "row") + " of " + counted(table.rows.size(), "row") +
            "; ./zwang report --figures svg writes all to tables/.";
  return {{"note", note}, {"columns", columns}, {"rows", rows}};
}

json to_json(const std::vector<Table>& tables, std::size_t most_rows) {
  json all = json::object();
  for (const Table& table : tables) all[table.id] = to_json(table, most_rows);
  return all;
}

// The object as text, with one member more that is text already.
std::string with_member(const json& object, const char* name, const std::string& value) {
  std::string text = object.dump(-1, ' ', false, json::error_handler_t::replace);
  text.back() = ',';
  return text + "\"" + name + "\":" + value + "}";
}

constexpr std::size_t drawn_by_default = 8;

const std::string& style(const SolverInfo& s) { return s.style.empty() ? s.name : s.style; }

// The solvers that charts show until a reader chooses, best first: those that reach the headline's error on most
// problems of the class, the fastest of those first; then the others. Both versions of a solver stay together.
std::vector<std::string> shown_by_default(const RunFolder& run) {
  std::map<std::string, std::vector<std::string>> versions;  // of a style
  std::map<std::string, std::string> style_of;
  for (const SolverInfo& s : run.solvers) versions[style_of[s.name] = style(s)].push_back(s.name);
  std::vector<std::string> order;
  for (const AccuracyMatched& entry : accuracy_matched(run.results, "", headline_error)) order.push_back(entry.solver);
  for (const SolverInfo& s : run.solvers) order.push_back(s.name);
  std::vector<std::string> shown;
  for (const std::string& name : order) {
    std::vector<std::string>& of_style = versions[style_of[name]];
    if (shown.size() + of_style.size() <= drawn_by_default) shown.insert(shown.end(), of_style.begin(), of_style.end());
    of_style.clear();
  }
  return shown;
}

// The section whose picture answers the question of the run's suite.
std::string opening(const RunFolder& run) {
  if (run.is_of_speed()) return "speed-ratios";
  const auto families = families_of(run.results);
  const bool atlas = !families.empty() && std::ranges::all_of(families, is_stability_family);
  return atlas ? "break-points" : "work-precision";
}

}  // namespace

std::vector<std::string> headline(const RunFolder& run) {
  if (run.results.empty()) return {"The run holds no results yet."};
  std::map<Verdict, std::size_t> verdicts;
  std::size_t lies = 0;
  std::map<std::string, int> problems;
  for (const Result& r : run.results) {
    ++verdicts[r.metrics.verdict];
    ++problems[r.problem];
    lies += r.lies();
  }
  const std::size_t right = verdicts[Verdict::solved] + verdicts[Verdict::infeasible_proven],
                    near = verdicts[Verdict::near], wrong = verdicts[Verdict::wrong],
                    consistent = verdicts[Verdict::consistent], rows_off = verdicts[Verdict::rows_off],
                    undecided = verdicts[Verdict::undecided] + verdicts[Verdict::infeasible_claimed],
                    blank = verdicts[Verdict::unsupported] + verdicts[Verdict::bad_input];
  const std::size_t failed = run.results.size() - right - near - wrong - consistent - rows_off - undecided - blank;
  std::string counts = counted(run.results.size(), "run") + " of " + counted(run.solvers.size(), "solver") + " on " +
                       counted(problems.size(), "problem") + ": " + grouped(right) + " right";
  for (const auto& [n, what] : {std::pair(near, "near"),
                                {wrong, "wrong"},
                                {consistent, "consistent"},
                                {rows_off, "right for rows that are off"},
                                {undecided, "undecided"},
                                {failed, "without an answer"},
                                {blank, "not applicable"}})
    if (n > 0) counts += ", " + grouped(n) + " " + what;
  std::vector<std::string> lines = {counts + (run.torn.empty() ? "." : ". " + run.torn)};
  if (lies == 0)
    lines.push_back("No run claimed success, or infeasibility, where the referee found the opposite.");
  else
    lines.push_back(counted(lies, "run") + " claimed an answer and " + (lies == 1 ? "was" : "were") +
                    " wrong: see the table of false claims.");
  if (const std::string line = handed_over(run); !line.empty()) lines.push_back(line);
  if (!run.recorded.empty())
    lines.push_back(counted(run.recorded.size(), "recorded answer") + " judged beside the runs, " +
                    std::to_string(std::ranges::count_if(run.recorded, &Result::is_right)) + " right.");
  return lines;
}

PageText page_text(const RunFolder& run) {
  std::vector<std::string> circumstances;
  for (const auto& [name, value] : run.conditions) {
    if (name == "commit") circumstances.push_back("commit " + value.substr(0, 12));
    if (name == "seed") circumstances.push_back("seed " + value);
    if (name == "compiler" || name == "CPU") circumstances.push_back(value);
  }
  const std::string title =
      run.title.empty() ? run.suite.empty() ? "zwang report" : "zwang: " + run.suite + " suite" : "zwang: " + run.title;
  return {title, headline(run), opening(run), joined(circumstances), notes(run), run.solvers, common_tables(run)};
}

std::string page_data(const PageText& text, const std::vector<RunFolder>& classes, const std::string& single,
                      std::size_t most_rows) {
  std::string parts;
  std::set<std::string> shown_somewhere;
  for (const RunFolder& part : classes) {
    const std::vector<std::string> shown = shown_by_default(part);
    shown_somewhere.insert(shown.begin(), shown.end());
    const std::string ranking = accuracy_headline(part);
    const json about = {{"name", part.problem_class},
                        {"ranking", ranking.empty() ? "" : ranking + "."},
                        {"families", families_of(part.results)},
                        {"solvers", names(part)},
                        {"shown", shown},
                        {"tables", to_json(class_tables(part), most_rows)}};
    parts += (parts.empty() ? "" : ",") + with_member(about, "charts", chart_rows(part));
  }
  json solvers = json::array();
  for (const SolverInfo& s : text.solvers)
    solvers.push_back({{"name", s.name},
                       {"method", s.method},
                       {"style", style(s)},
                       {"second", s.second},
                       {"exact", s.exact},
                       {"shown", shown_somewhere.contains(s.name)}});
  json about = {{"title", text.title},       {"opening", text.opening},
                {"headline", text.headline}, {"circumstances", text.circumstances},
                {"notes", text.notes},       {"solvers", solvers},
                {"levels", error_levels},    {"tables", to_json(text.tables, most_rows)}};
  if (!single.empty()) about["single"] = json::parse(single);
  return with_member(about, "classes", "[" + parts + "]");
}

std::string page(const std::string& data) { return filled(report_html(), data); }

std::string page_with_scripts(const std::string& data) {
  constexpr std::string_view inline_alone = "script-src 'unsafe-inline'";
  std::string whole = page(data);
  whole.replace(whole.find(inline_alone), inline_alone.size(), "script-src 'unsafe-inline' 'self' file:");
  return whole;
}

std::string collision_page(const std::string& data) { return filled(collision_html(), data); }

std::string league_page(const std::string& data) { return filled(league_html(), data); }

std::string filled(std::string_view whole, const std::string& data) {
  constexpr std::string_view slot = "{\"slot\":\"data\"}";
  const std::size_t at = whole.find(slot);
  if (at == std::string_view::npos) throw std::logic_error("the embedded report page has no place for its data");
  std::string out(whole.substr(0, at));
  out.reserve(whole.size() + data.size());
  for (const char ch : data) out += ch == '<' ? "\\u003c" : std::string_view(&ch, 1);  // no "</script" may end it
  out += whole.substr(at + slot.size());
  return out;
}

}  // namespace zwang::report
