#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/report/report.h>
#include <zwang/bench/suite/plan.h>

namespace zwang {

// "3.4in", "86mm", "8.6cm", "245pt" -> inches.
static double inches(const std::string& text) {
  static const std::map<std::string, double> units = {{"in", 1}, {"cm", 1 / 2.54}, {"mm", 1 / 25.4}, {"pt", 1 / 72.27}};
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  const auto unit = units.find(end);
  const double length = unit == units.end() ? 0 : number * unit->second;
  if (length >= 1.5 && length <= 20) return length;
  throw std::invalid_argument("--width " + text +
                              " should be a length from 1.5in to 20in, such as 3.4in, 86mm or 245pt");
}

int report_command(std::vector<std::string> words) {
  CLI::App options("Charts of stored results: DIR/report.html, files for a paper, or two runs side by side.");
  introduce(options, "report",
            "  ./zwang report results/20261120-2354\n"
            "  ./zwang report results/20261120-2354 --figures svg,pdf   DIR/figures/*, DIR/tables/*\n"
            "  ./zwang report results/20261120-2354 --figures pdf --chart work-precision --families hand \\\n"
            "                 --solvers nnls,dual_active_set --width 3.4in\n"
            "  ./zwang report before after --out compared.html");
  std::vector<std::string> runs;
  report::Figures figures;
  std::string out = "comparison.html", solvers, width;
  options.add_option("DIR", runs, "a run's folder, or two to compare")->required()->expected(1, 2)->type_name("");
  options.add_option("--out", out, "the page that compares two runs; default: comparison.html")->type_name("FILE");
  CLI::Option* print =
      options
          .add_option("--figures", figures.formats, "svg, pdf or svg,pdf: charts as files with their captions, tables")
          ->delimiter(',');
  options.add_option("--chart", figures.charts, "only these: work-precision, profile, ...; default: all")
      ->delimiter(',')
      ->needs(print)
      ->option_text("a,b,...");
  options.add_option("--solvers", solvers, "the figures' lines; default: the six best of each class")
      ->needs(print)
      ->option_text("a,b,...");
  options.add_option("--families", figures.families, "only figures of these; default: all")
      ->delimiter(',')
      ->needs(print)
      ->option_text("a,b,...");
  options.add_option("--width", width, "of a figure: 3.4in, 86mm, 245pt; type is 8 pt at any width")
      ->needs(print)
      ->option_text("LENGTH");
  if (!read(options, std::move(words))) return done;

  if (!solvers.empty()) figures.solvers = split_solvers(solvers);
  if (!width.empty()) figures.width = inches(width);
  if (runs.size() == 2) {
    if (!figures.formats.empty()) throw std::invalid_argument("--figures draws one run, not two");
    std::printf("Report: %s\n", report::write_comparison(runs[0], runs[1], out).c_str());
    return done;
  }
  std::vector<std::filesystem::path> files;
  if (!figures.formats.empty()) files = report::write_figures(runs[0], figures);
  std::printf("Report: %s\n", report::write_report(runs[0]).c_str());
  for (const auto& file : files) std::printf("%s\n", file.c_str());
  return done;
}

}  // namespace zwang
