#include <CLI/CLI.hpp>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/campaign/merge.h>
#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/report/report.h>
#include <zwang/bench/report/wording.h>
#include <zwang/bench/suite/progress.h>

namespace zwang {

int merge_command(std::vector<std::string> words) {
  CLI::App options("Joins the parts of a suite into one run, and writes its report.");
  introduce(options, "merge",
            "  ./zwang bench --suite quick --shard 0/2 --out part0\n"
            "  ./zwang bench --suite quick --shard 1/2 --out part1\n"
            "  ./zwang merge part0 part1 --out whole");
  std::vector<std::filesystem::path> parts;
  std::string out;
  options.add_option("DIR", parts, "folders of runs of one suite (--shard, or whole)")->required()->type_name("");
  options.add_option("--out", out, "folder of the joined run")->required()->type_name("DIR");
  const std::string command = command_line("merge", words);
  if (!read(options, std::move(words))) return done;
  const std::filesystem::path folder = new_directory(out, "");
  const Merged merged = merge(parts, folder, command);
  const std::string shown = report::shell_word(folder.string());
  std::printf("%s of %s runs", grouped(merged.present).c_str(), grouped(merged.planned).c_str());
  if (merged.twice > 0) std::printf(", %s of them twice and alike", grouped(merged.twice).c_str());
  if (merged.damaged > 0) std::printf(", %s damaged lines left out", grouped(merged.damaged).c_str());
  std::puts("");
  for (const std::string& line : merged.disagreeing) std::printf("%s\n", line.c_str());
  for (const std::string& file : merged.bad_problems)
    std::printf("%s is missing or damaged in every part: its runs are kept\n", file.c_str());
  if (merged.machines.size() > 1)
    for (const auto& [machine, runs] : merged.machines)
      std::printf("%s runs on %s\n", grouped(runs).c_str(), machine.c_str());
  if (merged.present < merged.planned)
    std::printf("%s: ./zwang bench --missing %s lists them\n",
                merged.planned == merged.present + 1
                    ? "1 run is missing"
                    : (grouped(merged.planned - merged.present) + " runs are missing").c_str(),
                shown.c_str());
  std::printf("Report: %s\n", report::write_report(folder).c_str());
  return merged.disagreeing.empty() ? done : found;
}

}  // namespace zwang
