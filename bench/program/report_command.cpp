#include <CLI/CLI.hpp>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/report/report.h>
#include <zwang/core/problem/did_you_mean.h>
#include <zwang/core/problem/wording.h>

namespace zwang {

int report_command(std::vector<std::string> words) {
  CLI::App options("Charts of stored results: DIR/report.html, files for a paper, or two runs side by side.");
  introduce(options, "report",
            "  ./zwang report results/20261120-2354\n"
            "  ./zwang report results/20261120-2354 --figures svg,pdf      DIR/figures/*, DIR/tables/*.tex and *.csv\n"
            "  ./zwang report before after --out compared.html");
  std::vector<std::string> runs;
  std::string figures, out = "comparison.html";
  options.add_option("DIR", runs, "a run's folder, or two to compare")->required()->expected(1, 2)->type_name("");
  options.add_option("--figures", figures, "svg, pdf or svg,pdf: each chart as a file, and the tables");
  options.add_option("--out", out, "the page that compares two runs; default: comparison.html")->type_name("FILE");
  if (!read(options, std::move(words))) return done;

  std::vector<std::string> formats;
  for (const std::string& format : split(figures)) {
    if (format != "svg" && format != "pdf")
      throw std::invalid_argument("no figure format '" + format + "'" + did_you_mean(format, {"svg", "pdf"}) +
                                  " (svg, pdf)");
    formats.push_back(format);
  }
  if (runs.size() == 2) {
    if (!formats.empty()) throw std::invalid_argument("--figures draws one run, not two");
    std::printf("Report: %s\n", report::write_comparison(runs[0], runs[1], out).c_str());
    return done;
  }
  std::printf("Report: %s\n", report::write_report(runs[0]).c_str());
  if (!formats.empty())
    for (const auto& file : report::write_figures(runs[0], formats)) std::printf("%s\n", file.c_str());
  return done;
}

}  // namespace zwang
