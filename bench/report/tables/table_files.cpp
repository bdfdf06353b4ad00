#include <algorithm>
#include <cmath>
#include <regex>
#include <sstream>
#include <utility>

#include <zwang/bench/report/tables/tables.h>
#include <zwang/bench/report/wording.h>

namespace zwang::report {
namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

// Our texts are ASCII; what TeX reads as commands is escaped, the backslash first.
std::string tex_text(std::string text) {
  text = replaced(std::move(text), "\\", "\\textbackslash ");
  for (const char* special : {"_", "%", "&", "#", "$", "{", "}"})
    text = replaced(std::move(text), special, std::string("\\") + special);
  text = replaced(std::move(text), "^", "\\^{}");
  text = replaced(std::move(text), "|", "$|$");
  text = replaced(std::move(text), "<=", "$\\le$");
  static const std::regex microseconds(" us\\b");
  return std::regex_replace(text, microseconds, " $$\\mu$$s");
}

}  // namespace

std::string csv_field(const std::string& text) {
  return text.find_first_of(",\"\n") == std::string::npos ? text : '"' + replaced(text, "\"", "\"\"") + '"';
}

void Table::add_columns(const std::string& titles) {
  std::stringstream parts(titles);
  for (std::string title; std::getline(parts >> std::ws, title, ';');) {
    const bool numeric = title.starts_with('#');
    columns.push_back({title.substr(numeric), numeric});
  }
}

std::string to_csv(const Table& table) {
  std::vector<std::string> fields;
  for (const Column& column : table.columns) fields.push_back(csv_field(column.name));
  std::string out = joined(fields, ",") + "\n";
  for (const Row& row : table.rows) {
    fields.clear();
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      const Cell& cell = row.cells[i];
      const bool number = table.columns[i].numeric && std::isfinite(cell.value);
      fields.push_back(number ? printed("%.9g", cell.value) : csv_field(cell.text));
    }
    out += joined(fields, ",") + "\n";
  }
  return out;
}

std::string to_tex(const Table& table) {
  std::string out = "% \\usepackage{booktabs}\n\\begin{table}\n\\centering\n\\caption{" + tex_text(table.note) +
                    "}\n\\label{tab:zwang-" + table.id + "}\n\\begin{tabular}{";
  std::vector<std::string> fields;
  for (const Column& column : table.columns) {
    out += column.numeric ? 'r' : 'l';
    fields.push_back(tex_text(column.name));
  }
  out += "}\n\\toprule\n" + joined(fields, " & ") + " \\\\\n\\midrule\n";
  for (const Row& row : table.rows) {
    fields.clear();
    for (const Cell& cell : row.cells) fields.push_back(tex_text(cell.text));
    out += joined(fields, " & ") + " \\\\\n";
  }
  return out + "\\bottomrule\n\\end{tabular}\n\\end{table}\n";
}

}  // namespace zwang::report
