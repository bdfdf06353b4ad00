#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include <zwang/bench/report/tables/tables.h>
#include <zwang/core/files/embedded.h>

ZWANG_EMBEDDED(tables_json, ZWANG_TABLES)

namespace zwang::report {
namespace {

// tables.json: of each table its columns, what its figures mean, and why there may be none, where that is another text.
std::string text_of(const std::string& table, const char* name) {
  static const nlohmann::json all = nlohmann::json::parse(tables_json());
  const nlohmann::json& own = all.at(table);
  return own.contains(name) ? own[name] : own.at("rows");
}

}  // namespace

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
