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

namespace zwang::report {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) {
  if (file.has_parent_path()) fs::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

std::string title(const Run& run) {
  if (!run.title.empty()) return "zwang: " + run.title;
  return run.suite.empty() ? "zwang report" : "zwang: " + run.suite + " suite";
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
  const Run run = read_run(dir);
  fs::remove_all(dir / "runs");
  if (!run.is_large()) {
    write(page_file, page(page_data(run, {title(run), headline(run)}, all_tables(run))));
    return page_file;
  }
  const SingleRuns single = single_run_scripts(run);
  for (std::size_t i = 0; i < single.scripts.size(); ++i)
    write(dir / "runs" / (std::to_string(i) + ".js"), single.scripts[i]);
  write(page_file, page_with_scripts(page_data(run, {title(run), headline(run)}, all_tables(run), single.index)));
  return page_file;
}

fs::path write_comparison(const fs::path& run_a, const fs::path& run_b, const fs::path& out) {
  const Run a = read_run(run_a), b = read_run(run_b), both = merged(a, b);
  std::vector<Table> tables = all_tables(both);
  tables.insert(tables.begin(), comparison_table(a, b));
  std::vector<std::string> lines = headline(both);
  lines.insert(lines.begin(), "Run A is " + a.label + ", run B is " + b.label + ".");
  write(out, page(page_data(both, {"zwang: " + a.label + " against " + b.label, lines}, tables)));
  return out;
}

std::vector<fs::path> write_figures(const fs::path& dir, const std::vector<std::string>& formats) {
  for (const std::string& format : formats)
    if (format != "svg" && format != "pdf")
      throw std::runtime_error("no figure format '" + format + "'; there are svg and pdf");
  const Run run = read_run(dir);
  const std::vector<Table> tables = all_tables(run);
  std::vector<fs::path> files;
  for (const Table& table : tables) {
    if (table.rows.empty()) continue;
    write(files.emplace_back(dir / "tables" / (table.id + ".csv")), to_csv(table));
    write(files.emplace_back(dir / "tables" / (table.id + ".tex")), to_tex(table));
  }
  const fs::path figures = dir / "figures", data = figures / "data.json";
  write(data, page_data(run, {title(run), headline(run)}, tables));
  draw_figures(data, figures, formats);
  fs::remove(data);
  for (const auto& entry : fs::directory_iterator(figures)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace zwang::report
