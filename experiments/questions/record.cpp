#include <zwang/experiments/questions/record.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include <zwang/bench/report/page/draw.h>
#include <zwang/bench/timing/conditions.h>
#include <zwang/core/files/stored_file.h>

namespace zwang::questions {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Point, series, x, y)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Level, y, text)
NLOHMANN_JSON_SERIALIZE_ENUM(Chart::Kind, {{Chart::Kind::lines, "lines"},
                                           {Chart::Kind::points, "points"},
                                           {Chart::Kind::shares, "shares"}})
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Chart, name, title, x, y, kind, log_x, log_y, points, levels, figure)

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::vector<std::vector<std::string>> with_head(const Findings& findings) {
  std::vector<std::vector<std::string>> rows = findings.rows;
  rows.insert(rows.begin(), findings.columns);
  return rows;
}

// Quoted where a comma or a quote would end it.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char ch : text) out += ch == '"' ? "\"\"" : std::string(1, ch);
  return out + "\"";
}

std::string to_csv(const Findings& findings) {
  std::string text;
  for (const auto& row : with_head(findings))
    for (std::size_t k = 0; k < row.size(); ++k) text += csv_field(row[k]) + (k + 1 < row.size() ? "," : "\n");
  return text;
}

}  // namespace

std::string to_text(const Findings& findings) {
  const auto rows = with_head(findings);
  std::vector<std::size_t> width(findings.columns.size(), 0);
  for (const auto& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k) width[k] = std::max(width[k], row[k].size());
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t k = 0; k < row.size(); ++k) line += row[k] + std::string(width[k] - row[k].size() + 2, ' ');
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  for (const std::string& remark : findings.remarks) text += remark + "\n";
  return text;
}

std::vector<fs::path> record(const Findings& findings, const Question& question, const std::string& command,
                             const fs::path& directory) {
  fs::create_directories(directory);
  const Conditions c = conditions();
  const json all = {{"question", question.line},
                    {"paper", question.paper},
                    {"command", command},
                    {"circumstances", "zwang " + c.commit.substr(0, 12) + (c.dirty ? ", changed" : "") + ", " +
                                          c.compiler + ", " + c.cpu},
                    {"columns", findings.columns},
                    {"rows", findings.rows},
                    {"remarks", findings.remarks},
                    {"charts", findings.charts}};
  std::vector<fs::path> files = {directory / (question.name + ".csv"), directory / (question.name + ".json")};
  replace_file(files[0], to_csv(findings));
  replace_file(files[1], all.dump(1, ' ', false, json::error_handler_t::replace));
  if (!findings.charts.empty()) report::draw(files[1], directory);
  for (const Chart& chart : findings.charts)
    if (const fs::path file = directory / ((chart.figure.empty() ? chart.name : chart.figure) + ".svg");
        std::ranges::find(files, file) == files.end())
      files.push_back(file);
  return files;
}

}  // namespace zwang::questions
