#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <thread>

#include <zwang/bench/fuzz/worker.h>
#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/report/wording.h>
#include <zwang/bench/suite/progress.h>

namespace zwang {

int fuzz_command(std::vector<std::string> words) {
  CLI::App options(
      "Solves small problems with known answers and says where a solver's claim is not true. Their entries are -1, 0, "
      "1: ties, repeated, contradicting and empty rows are the rule. Some get warm starts, some NaN, Inf or "
      "1e300.");
  introduce(options, "fuzz",
            "  ./zwang fuzz --count 20000\n"
            "  ./zwang fuzz --count 1000000 --seed 2 --solvers dual_active_set,nnls --out findings\n"
            "  ./zwang fuzz --referee --count 1000\n"
            "Exit code 1 where there is a finding.");
  FuzzOptions fuzz{.count = 20000};
  std::string out = "fuzz-findings";
  int jobs = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 16u));
  within(from(1), options.add_option("--count", fuzz.count, "number of problems; default: 20000"));
  within(from(0), options.add_option("--seed", fuzz.seed, "of all draws; default: 1"));
  within(from(0), options.add_option("--first", fuzz.first, "number of the first problem; default: 0"));
  options.add_flag("--near", fuzz.near, "rows 2^-22 to 2^-50 from dependent instead, against 100 digits");
  options.add_flag("--friction", fuzz.friction,
                   "contacts with friction instead, under Coulomb's law; with --accuracy under the convex one, too");
  options.add_flag("--referee", fuzz.referee, "verdicts on invented answers instead, against rationals");
  options.add_option("--solvers", fuzz.solvers,
                     "a,b,...; default: all native ones but nnls_paper; with --near none of first order, whose small "
                     "residuals say nothing of z there");
  options.add_option("--accuracy", fuzz.accuracy, "asked of all, as of ./zwang solve: checks what they promise")
      ->type_name("A");
  within(from_to(1, 64), options.add_option("--jobs", jobs, "processes; default: one a core"));
  options.add_option("--out", out, "folder for the findings; default: fuzz-findings")->type_name("DIR");
  if (!read(options, std::move(words))) return done;
  if (fuzz.near + fuzz.friction + fuzz.referee > 1)
    throw std::invalid_argument("--near, --friction and --referee exclude each other");
  if (fuzz.referee && !fuzz.solvers.empty()) throw std::invalid_argument("--referee asks no solvers");
  if (fuzz.first > std::numeric_limits<std::uint64_t>::max() - fuzz.count)
    throw std::invalid_argument("--first: expected at most 2^64 - 1 - --count");
  SolveOptions().read_accuracy(fuzz.accuracy);
  if (!fuzz.accuracy.empty() && fuzz.referee) throw std::invalid_argument("--referee asks for no accuracy");

  Progress bar;
  const auto progress = [&](std::uint64_t so_far) {
    bar.show(static_cast<double>(so_far) / static_cast<double>(fuzz.count), grouped(so_far) + " problems");
  };
  const bool made = std::filesystem::create_directories(out);  // that it cannot be is said now
  const FuzzOutcome o = run_fuzz(fuzz, jobs, out, solvers(), progress, stop_on_interrupt());
  bar.clear();
  if (made && std::filesystem::is_empty(out)) std::filesystem::remove(out);
  const std::string seed = std::to_string(fuzz.seed);
  std::printf("%s problems (seed %s) in %s\n\n", grouped(o.done).c_str(), seed.c_str(), duration(o.seconds).c_str());
  if (fuzz.referee)
    std::printf("%-20s %10s %12s %10s %12s %10s %8s %11s\n", "class", "judgements", "right, given", "undecided",
                "z alone", "undecided", "false", "time each");
  else
    std::printf("%-20s %10s %10s %9s %10s %10s %8s %8s %9s %11s\n", "solver", "runs", "solved", "flagged", "proven",
                "undecided", "decided", "faults", "z error", "time a run");
  for (std::size_t i = 0; i < o.solvers.size(); ++i) {
    const FuzzTally& t = o.tally[i];
    const double all = static_cast<double>(std::max<std::uint64_t>(1, t.runs + t.warm + t.spoilt));
    const std::string each = report::duration(t.seconds / all);
    if (fuzz.referee) {
      const auto share = [&](int k) {
        return 100. * double(t.open[k]) / double(std::max<std::uint64_t>(1, t.right[k]));
      };
      std::printf("%-20s %10s %12s %9.3f%% %12s %9.3f%% %8s %11s\n", o.solvers[i].c_str(), grouped(t.runs).c_str(),
                  grouped(t.right[1]).c_str(), share(1), grouped(t.right[0]).c_str(), share(0),
                  grouped(t.faults).c_str(), each.c_str());
      continue;
    }
    std::printf("%-20s %10s %10s %9s %10s %10s %7.3f%% %8s %9s %11s\n", o.solvers[i].c_str(), grouped(t.runs).c_str(),
                grouped(t.solved).c_str(), grouped(t.flagged).c_str(), grouped(t.proven).c_str(),
                grouped(t.undecided).c_str(), 100 * t.decided(), grouped(t.faults).c_str(),
                report::scientific(t.worst_z_error).c_str(), each.c_str());
    if (!fuzz.accuracy.empty())
      std::printf("%20s %10s promises, %s of them within ten times the error\n", "", grouped(t.promised).c_str(),
                  grouped(t.tight).c_str());
  }
  std::vector<std::string> told;  // in a list; here the first few, or all where it cannot be written
  const std::string kind = fuzz.near ? " --near" : fuzz.friction ? " --friction" : fuzz.referee ? " --referee" : "";
  for (const Finding& f : o.findings) {
    const std::string number = std::to_string(f.number),
                      by = f.solver + (fuzz.accuracy.empty() ? "" : " --accuracy ") + fuzz.accuracy;
    told.push_back("problem " + number + ", " + f.solver + " " + f.what + "\n  ./zwang ");
    if (f.file.empty() || fuzz.referee)
      told.back() += "fuzz" + kind + " --seed " + seed + " --first " + number + " --count 1" +
                     (fuzz.referee ? "" : " --solvers " + by);
    else
      told.back() += "solve " + report::shell_word(f.file) + " --solver " + by;
  }
  const std::string list = std::filesystem::path(out) / "findings.txt";
  const std::string all = "Seed " + seed + kind + "\n" + joined(told, "\n");
  const bool listed = told.empty() || (std::ofstream(list, std::ios::app) << all << std::endl);
  const std::size_t shown = listed ? std::min<std::size_t>(told.size(), 20) : told.size();
  for (std::size_t k = 0; k < shown; ++k) std::printf("%s%s\n", k == 0 ? "\n" : "", told[k].c_str());
  if (shown < told.size()) std::printf("and %s more: %s\n", grouped(told.size() - shown).c_str(), list.c_str());
  if (o.interrupted) return stopped;
  return o.findings.empty() ? done : found;
}

}  // namespace zwang
