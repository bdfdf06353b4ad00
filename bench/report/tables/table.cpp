#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include <zwang/bench/report/tables/tables.h>
#include <zwang/bench/report/wording.h>
#include <zwang/core/files/embedded.h>

ZWANG_EMBEDDED(tables_json, ZWANG_TABLES)

namespace zwang::report {
namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

// tables.json: of each table its columns, what its figures mean, and why there may be none, where that is another text.
std::string text_of(const std::string& table, const char* name) {
  static const nlohmann::json all = nlohmann::json::parse(tables_json());
  const nlohmann::json& own = all.at(table);
  return own.contains(name) ? own[name] : own.at("rows");
}

}  // namespace

std::string csv_field(const std::string& text) {
  return text.find_first_of(",\"\n") == std::string::npos ? text : '"' + replaced(text, "\"", "\"\"") + '"';
}

Table::Table(std::string name) : id(std::move(name)) { add_columns(text_of(id, "columns")); }

void Table::explain(const char* with_rows) { note = text_of(id, rows.empty() ? "none" : with_rows); }

void Table::add_columns(const std::string& titles) {
  std::stringstream parts(titles);
  for (std::string title; std::getline(parts >> std::ws, title, ';');) {
    const bool numeric = title.starts_with('#');
    columns.push_back({title.substr(numeric), numeric});
  }
}

}  // namespace zwang::report
