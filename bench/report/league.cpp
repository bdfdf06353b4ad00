#include <zwang/bench/report/report.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include <zwang/bench/report/page/page.h>
#include <zwang/bench/report/results.h>
#include <zwang/core/files/embedded.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>

ZWANG_EMBEDDED(league_html, ZWANG_LEAGUE_PAGE)

namespace zwang::report {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Versions in their natural order: 0.9 before 0.10.
struct Natural {
  bool operator()(const std::string& a, const std::string& b) const { return strverscmp(a.c_str(), b.c_str()) < 0; }
};

json or_null(double number) { return std::isfinite(number) ? json(number) : json(); }

json read_entry(const fs::path& file) {
  json entry = json::parse(read_stored(file).bytes, nullptr, false);
  if (entry.is_object() && !entry.contains("reply")) entry["reply"] = "";
  for (const char* key : {"solver", "version", "url", "reply"})
    if (!entry.is_object() || !entry[key].is_string())
      throw BadFile(file.string() + ": " + key +
                    R"(: expected {"solver": "...", "version": "...", "url": "...", "reply": "..."})");
  if (const std::string url = entry["url"]; !url.empty() && !url.starts_with("https://") && !url.starts_with("http://"))
    throw BadFile(file.string() + ": url: expected https://...");
  return {{"solver", entry["solver"]}, {"version", entry["version"]}, {"url", entry["url"]}, {"reply", entry["reply"]}};
}

// What the solver made of each problem: [right, claimed falsely, proven error, seconds]; null where another one
// answered in its place.
json judgement(const fs::path& directory, const std::string& solver, std::map<std::string, std::string>& problems) {
  const RunFolder run = read_run(directory, std::numeric_limits<std::size_t>::max());
  std::map<std::string, json> rows;
  std::string machine;
  bool there = std::ranges::any_of(run.handed_over, [&](const auto& over) { return over.first.first == solver; });
  for (const Result& r : run.results) {
    problems[r.problem_sha256] = r.problem;
    json& row = rows[r.problem_sha256];
    machine = r.machine;
    if (r.solver != solver) continue;
    row = {r.is_right(), r.lies(), or_null(r.error()), or_null(r.solve_s)};
    there = true;
  }
  if (!there) throw BadFile(directory.string() + ": no answer of " + solver + ", which entry.json names");
  json list = json::array();
  for (auto& [sha256, row] : rows) list.push_back(std::move(row));
  return {{"machine", machine}, {"rows", list}};
}

}  // namespace

std::string league_page(const std::vector<fs::path>& records) {
  std::map<std::string, std::map<std::string, std::string>> packs;  // of each the problems' names
  std::map<std::string, std::map<std::string, json, Natural>> entries;
  for (const fs::path& record : records) {
    json entry = read_entry(record / "entry.json");
    const std::string solver = entry["solver"], version = entry["version"];
    for (const fs::directory_entry& at : fs::directory_iterator(record)) {
      if (!fs::exists(at.path() / "results.jsonl")) continue;
      const std::string pack = at.path().filename().string();
      std::map<std::string, std::string> problems;
      entry["packs"][pack] = judgement(at.path(), solver, problems);
      if (packs.try_emplace(pack, problems).first->second != problems)
        throw BadFile(at.path().string() + ": another pack than the " + pack + " of other records");
    }
    if (!entry.contains("packs"))
      throw BadFile(record.string() + ": no judgement; expected what ./zwang judge PACK ANSWERS --out " +
                    (record / "PACK").string() + " writes");
    if (!entries[solver].emplace(version, std::move(entry)).second)
      throw BadFile(record.string() + ": a second record of " + solver + " " + version);
  }
  json data = {{"packs", json::object()}, {"entries", json::array()}};
  for (const auto& [pack, problems] : packs)
    for (const auto& [sha256, problem] : problems) data["packs"][pack].push_back(problem);
  for (auto& [solver, versions] : entries)
    for (auto& [version, entry] : versions) data["entries"].push_back(std::move(entry));
  return filled(league_html(), data.dump(-1, ' ', false, json::error_handler_t::replace));
}

}  // namespace zwang::report
