#include <zwang/bench/report/report.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/bench/report/compare.h>
#include <zwang/bench/report/page/draw.h>
#include <zwang/bench/report/page/page.h>
#include <zwang/bench/report/page/single_runs.h>
#include <zwang/bench/report/tables/tables.h>
#include <zwang/core/files/stored_file.h>

namespace zwang::report {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) {
  if (file.has_parent_path()) fs::create_directories(file.parent_path());
  replace_file(file, text);
}

// Of the names of files: "-convex-cone"; "" where there is one class.
std::string class_ending(std::string name) {
  for (char& ch : name) ch = ch == ' ' ? '-' : static_cast<char>(std::tolower(ch));
  return name.empty() ? "" : "-" + name;
}

std::string collision_data(const fs::path& file) try {
  std::ifstream in(file);
  using nlohmann::json;
  return json::parse(in).dump(-1, ' ', false, json::error_handler_t::replace);
} catch (const nlohmann::json::exception&) {
  throw std::runtime_error(file.string() + ": not the results of a collision run");
}

}  // namespace

fs::path write_report(const fs::path& dir) {
  const fs::path page_file = dir / "report.html", collision = dir / "collision.json";
  if (fs::exists(collision)) {
    write(page_file, collision_page(collision_data(collision)));
    return page_file;
  }
  Run run = read_run(dir);
  fs::remove_all(dir / "runs");
  const PageText text = page_text(run);
  const SingleRuns single = run.is_large() ? single_run_scripts(run) : SingleRuns();
  for (std::size_t i = 0; i < single.scripts.size(); ++i)
    write(dir / "runs" / (std::to_string(i) + ".js"), single.scripts[i]);
  const std::string data = page_data(text, by_class(std::move(run)), single.index);
  write(page_file, single.scripts.empty() ? page(data) : page_with_scripts(data));
  return page_file;
}

fs::path write_comparison(const fs::path& run_a, const fs::path& run_b, const fs::path& out) {
  const Run a = read_run(run_a), b = read_run(run_b);
  Run both = merged(a, b);
  PageText text = page_text(both);
  text.title = "zwang: " + a.label + " against " + b.label;
  text.headline.insert(text.headline.begin(), "Run A is " + a.label + ", run B is " + b.label + ".");
  text.tables.push_back(comparison_table(a, b));
  write(out, page(page_data(text, by_class(std::move(both)))));
  return out;
}

std::vector<fs::path> write_figures(const fs::path& dir, const std::vector<std::string>& formats) {
  for (const std::string& format : formats)
    if (format != "svg" && format != "pdf")
      throw std::runtime_error("no figure format '" + format + "'; there are svg and pdf");
  Run run = read_run(dir);
  const PageText text = page_text(run);
  const std::vector<Run> classes = by_class(std::move(run));
  std::vector<fs::path> files;
  const auto write_tables = [&](const std::vector<Table>& tables, const std::string& ending) {
    for (const Table& table : tables) {
      if (table.rows.empty()) continue;
      write(files.emplace_back(dir / "tables" / (table.id + ending + ".csv")), to_csv(table));
      write(files.emplace_back(dir / "tables" / (table.id + ending + ".tex")), to_tex(table));
    }
  };
  write_tables(text.tables, "");
  for (const Run& part : classes) write_tables(class_tables(part), class_ending(part.problem_class));
  const fs::path figures = dir / "figures", data = figures / "data.json";
  write(data, page_data(text, classes));
  draw_figures(data, figures, formats);
  fs::remove(data);
  for (const auto& entry : fs::directory_iterator(figures)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace zwang::report
