#include <unistd.h>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/scenes/recorded_data.h>
#include <zwang/core/problem/did_you_mean.h>
#include <zwang/experiments/program/commands.h>
#include <zwang/experiments/questions/play.h>
#include <zwang/experiments/questions/record.h>

namespace zwang {

static std::string list_of_questions() {
  std::string text = "Questions:\n";
  for (const questions::Question& q : questions::questions()) {
    text += "  " + q.name + std::string(q.name.size() < 14 ? 14 - q.name.size() : 1, ' ') + q.line + "\n";
    text += std::string(16, ' ') + "paper: " + q.paper + "\n";
  }
  return text;
}

int experiment_command(std::vector<std::string> words) {
  CLI::App options(
      "Asks a question that the paper answers, and puts the answer of a run here beside it: a table, charts.");
  introduce(options, "experiment",
            "  ./zwang experiment fig8\n"
            "  ./zwang experiment separation --out docs/figures\n"
            "  ./zwang experiment all --seconds 2\n\n" +
                list_of_questions());
  std::string name, out = "results/experiments", parts;
  questions::Asking asking{
      .data = recorded_data(), .interrupted = &stop_on_interrupt(), .terminal = isatty(STDERR_FILENO) == 1};
  options.add_option("NAME", name, "of the question, or all")->required()->type_name("");
  options.add_option("--out", out, "folder of the table and the charts; default: results/experiments")
      ->type_name("DIR");
  options.add_option("--solver", asking.solver, "of the questions that compare no solvers")->type_name("NAME");
  options.add_option("--motion", asking.motion, "a recording in place of the question's own motion")->type_name("FILE");
  options.add_option("--parts", parts, "folder of real parts in place of procedural ones")->type_name("DIR");
  within(above(0, "s"), options.add_option("--seconds", asking.seconds, "of motion; default: all of it"));
  if (!read(options, std::move(words))) return done;
  asking.parts = parts;

  std::vector<std::string> names = {"all"};
  bool known = name == "all";
  for (const questions::Question& q : questions::questions()) {
    names.push_back(q.name);
    known = known || q.name == name;
  }
  if (!known)
    throw std::invalid_argument("no question '" + name + "'" + did_you_mean(name, names) +
                                " (./zwang experiment --help lists all)");
  std::string chosen;  // what decides the answer, for whoever repeats it
  if (options.count("--solver") > 0) chosen += " --solver " + asking.solver;
  if (!asking.motion.empty()) chosen += " --motion " + asking.motion;
  if (!parts.empty()) chosen += " --parts " + parts;
  if (asking.seconds > 0) chosen += " --seconds " + questions::number(asking.seconds);
  for (const questions::Question& q : questions::questions()) {
    if (name != "all" && q.name != name) continue;
    std::printf("%s\n", q.line.c_str());
    std::fflush(stdout);
    try {
      const questions::Findings found = q.ask(asking);
      std::printf("%s", questions::to_text(found).c_str());
      for (const auto& file : questions::record(found, q, "./zwang experiment " + q.name + chosen, out))
        std::printf("  %s\n", file.c_str());
    } catch (const questions::Interrupted&) {
      std::printf("Stopped within '%s'; what was finished before is in %s\n", q.name.c_str(), out.c_str());
      return stopped;
    }
    std::printf("\n");
  }
  return done;
}

}  // namespace zwang
