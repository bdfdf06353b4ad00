#include <zwang/bench/report/report.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <zwang/bench/report/page/draw.h>
#include <zwang/bench/report/page/page.h>
#include <zwang/bench/report/tables/tables.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/core/problem/did_you_mean.h>

namespace zwang::report {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) {
  if (file.has_parent_path()) fs::create_directories(file.parent_path());
  replace_file(file, text);
}

void require_known(const std::string& what, const std::vector<std::string>& names,
                   const std::vector<std::string>& known) {
  for (const std::string& name : names)
    if (std::ranges::find(known, name) == known.end())
      throw std::invalid_argument("no " + what + " '" + name + "'" + did_you_mean(name, known) + " (" + joined(known) +
                                  ")");
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
  RunFolder run = read_run(dir);
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
  const RunFolder a = read_run(run_a), b = read_run(run_b);
  RunFolder both = merged(a, b);
  PageText text = page_text(both);
  text.title = "zwang: " + a.label + " against " + b.label;
  text.headline.front().insert(0, "Run A is " + a.label + ", run B is " + b.label + ". ");
  text.tables.push_back(comparison_table(a, b));
  write(out, page(page_data(text, by_class(std::move(both)))));
  return out;
}

std::vector<fs::path> write_figures(const fs::path& dir, const Figures& asked) {
  require_known("figure format", asked.formats, {"svg", "pdf"});
  require_known("chart", asked.charts,
                {"work-precision", "families", "profile", "data-profile", "convergence-iteration", "convergence-time",
                 "scaling", "speed-ratios", "speed-exponents", "sweep", "range-gap", "stages"});
  RunFolder run = read_run(dir);
  require_known("solver", asked.solvers, solvers_of(run.results));
  require_known("family", asked.families, families_of(run.results));
  const PageText text = page_text(run);
  const std::vector<RunFolder> classes = by_class(std::move(run));
  const fs::path figures = dir / "figures", tables = dir / "tables", data = figures / "data.json";
  fs::create_directories(tables);
  const nlohmann::json print = {{"formats", asked.formats},
                                {"charts", asked.charts},
                                {"solvers", asked.solvers},
                                {"families", asked.families},
                                {"width", asked.width}};
  write(data, "{\"print\":" + print.dump() + ",\"page\":" + page_data(text, classes, {}, std::string::npos) + "}");
  draw_figures(data, figures, tables);
  fs::remove(data);
  std::vector<fs::path> files;
  for (const fs::path& folder : {figures, tables})
    for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace zwang::report
