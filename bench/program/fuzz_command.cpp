#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <ranges>
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
                   "contacts with friction instead, under Coulomb's law; with --accuracy the convex one");
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
  const bool made =
      std::filesystem::create_directories(out);  // that it cannot be is said now, not with the first finding
  const FuzzOutcome o = run_fuzz(fuzz, jobs, out, solvers(), progress, stop_on_interrupt());
  bar.clear();
  if (made && std::filesystem::is_empty(out)) std::filesystem::remove(out);

  std::printf("%s problems (seed %llu) in %s\n\n", grouped(o.done).c_str(), static_cast<unsigned long long>(fuzz.seed),
              duration(o.seconds).c_str());
  if (fuzz.referee)
    std::printf("%-20s %10s %12s %10s %12s %10s %8s %11s\n", "class", "judgements", "right, given", "undecided",
                "z alone", "undecided", "false", "time each");
  else
    std::printf("%-20s %10s %10s %9s %10s %10s %8s %8s %9s %11s\n", "solver", "runs", "solved", "flagged", "proven",
                "undecided", "decided", "faults", "z error", "time a run");
  for (std::size_t i = 0; i < o.solvers.size(); ++i) {
    const FuzzTally& t = o.tally[i];
    const std::uint64_t all = t.runs + t.warm + t.spoilt;
    if (fuzz.referee) {
      const auto share = [&](int k) {
        return 100. * double(t.open[k]) / double(std::max<std::uint64_t>(1, t.right[k]));
      };
      std::printf("%-20s %10s %12s %9.3f%% %12s %9.3f%% %8s %11s\n", o.solvers[i].c_str(), grouped(t.runs).c_str(),
                  grouped(t.right[1]).c_str(), share(1), grouped(t.right[0]).c_str(), share(0),
                  grouped(t.faults).c_str(),
                  report::duration(t.seconds / double(std::max<std::uint64_t>(1, all))).c_str());
      continue;
    }
    std::printf("%-20s %10s %10s %9s %10s %10s %7.3f%% %8s %9s %11s\n", o.solvers[i].c_str(), grouped(t.runs).c_str(),
                grouped(t.solved).c_str(), grouped(t.flagged).c_str(), grouped(t.proven).c_str(),
                grouped(t.undecided).c_str(), 100 * t.decided(), grouped(t.faults).c_str(),
                report::scientific(t.worst_z_error).c_str(),
                report::duration(t.seconds / static_cast<double>(std::max<std::uint64_t>(1, all))).c_str());
    if (!fuzz.accuracy.empty())
      std::printf("%20s %10s promises, %s of them within ten times the error\n", "", grouped(t.promised).c_str(),
                  grouped(t.tight).c_str());
  }
  constexpr std::size_t most_shown = 20;
  if (!o.findings.empty()) std::puts("");
  for (const Finding& f : o.findings | std::views::take(most_shown)) {
    std::printf("problem %llu, %s %s\n", static_cast<unsigned long long>(f.number), f.solver.c_str(), f.what.c_str());
    if (fuzz.referee)
      std::printf("  ./zwang fuzz --referee --seed %llu --first %llu --count 1\n",
                  static_cast<unsigned long long>(fuzz.seed), static_cast<unsigned long long>(f.number));
    else if (!f.file.empty())
      std::printf("  ./zwang solve %s --solver %s\n", report::shell_word(f.file).c_str(), f.solver.c_str());
  }
  if (o.findings.size() > most_shown)
    std::printf("and %s more; files in %s\n", grouped(o.findings.size() - most_shown).c_str(), out.c_str());
  if (o.interrupted) return stopped;
  return o.findings.empty() ? done : found;
}

}  // namespace zwang
