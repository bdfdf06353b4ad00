#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/report/wording.h>
#include <zwang/bench/results/record_file.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/bench/suite/run_record.h>
#include <zwang/bench/suite/suite.h>
#include <zwang/bench/timing/conditions.h>

namespace zwang {
namespace {

std::string counts(const Tally& t) {
  std::string text = grouped(t.solved) + " solved, " + grouped(t.near) + " near, " + grouped(t.wrong) + " wrong, " +
                     grouped(t.failed) + " failed";
  if (t.undecided > 0) text += ", " + grouped(t.undecided) + " undecided";
  if (t.unsupported > 0) text += ", " + grouped(t.unsupported) + " not applicable";
  if (t.lies > 0)
    text += "   (" + grouped(t.lies) + (t.lies == 1 ? " of them was" : " of them were") +
            " claimed as success: see the table of false claims)";
  if (t.recorded > 0) text += "; " + grouped(t.recorded) + " recorded answers judged";
  return text;
}

// What a resumed run did not have to do again.
std::string earlier(const Outcome& o) {
  if (o.earlier == 0) return "";
  return o.earlier == o.planned ? ", all of them before" : ", " + grouped(o.earlier) + " of them before";
}

struct Asked {
  SuiteOptions suite = {};
  std::string tolerances = {}, out = {}, resume = {};
  std::vector<std::string> missing = {};
  bool plan = false, gradients = false;
};

void add_options(CLI::App& options, Asked& asked) {
  SuiteOptions& s = asked.suite;
  options.option_defaults()->group("What is run");
  options.add_option(
      "--suite", s.suite,
      "quick (a minute), standard (ten minutes, the default), full (hours), atlas (stability, 15 "
      "minutes), speed (ten minutes), big (a million runs), large (twenty thousand, with foreign solvers: "
      "docs/campaigns.md) or collision (ten minutes)");
  options.add_option("--scenes", s.scenes, "scenes with their knobs, in place of the suite's (./zwang scenes)");
  options.add_option("--families", s.families, "MR,NPE,...: only these families of the problems");
  options.add_option("--problems", s.problems, "problem files (FCLIB or zwang's HDF5), or folders of them")
      ->type_name("PATH");
  add_laws(options, s.laws);
  options.add_option("--solvers", s.solvers, "a,b:key=value,...; default: all (./zwang solvers)");
  options.add_option("--tolerances", asked.tolerances, "1e-2,1e-6,...; default: the suite's ladder");
  within(from(0), options.add_option("--seed", s.seed, "of every scene whose knobs do not say"));
  options.add_flag("--gradients", asked.gradients,
                   "no solvers: how far off gradients are that are made by differences and by soft rows, of "
                   "--scenes under --law (minutes; needs ./zwang python)");
  options.option_defaults()->group("How it is run");
  within(from(1), options.add_option("--repetitions", s.repetitions,
                                     "timed solves of each run; default: as many as time allows"));
  within(above(0, "s"),
         options.add_option("--time-limit", s.time_limit,
                            "CPU time of a solve; default: the suite's, shortened where it would not end in time"))
      ->type_name("S");
  options.add_flag("--accuracy", s.accuracy, "no repetitions: accuracy alone, times are of first solves");
  options.add_flag("--trace", s.trace, "convergence of every solver on every problem, not only on one a family");
  options.add_flag("--sequence", s.sequence,
                   "the problems of a family are successive frames: time each also from the answer of the one before");
  options.add_flag("--plan", asked.plan, "say what would be run, and run nothing");
  options.add_option("--shard", asked.suite.shard, "only part K of N, K from 0; joined by ./zwang merge")
      ->type_name("K/N");
  options.option_defaults()->group("Where it goes");
  options.add_option("--out", asked.out, "folder for the results; default: results/<date>-<time>")->type_name("DIR");
  options.add_option("--resume", asked.resume, "go on with a run that was stopped")->type_name("DIR");
  options
      .add_option("--missing", asked.missing, "list the runs of a folder, or of a suite's parts, that are not there")
      ->type_name("DIR");
}

// Of a run that goes on: after the first problem, then every 10 s, and for a twentieth of the time at most. `next`: not
// before, s of the monotonic clock. That a page cannot be written is no reason to end the run; its end says so.
void report_so_far(const std::string& directory, double& next) {
  const double start = wall_seconds();
  if (start < next) return;
  write_report({":so-far", directory}, true);
  next = wall_seconds() + std::max(10.0, 20 * (wall_seconds() - start));
}

// The problems of this part by family, and how long a run may take.
int print_plan(const Plan& plan) {
  struct Family {
    std::size_t problems = 0;
    Index fewest = std::numeric_limits<Index>::max(), most = 0;
  };
  std::map<std::string, Family> families;
  for (std::size_t k = plan.shard.part; k < plan.instances.size(); k += plan.shard.of) {
    Family& own = families[plan.instances[k].family];
    const Index size = plan.instances[k].problem.size();
    own = {own.problems + 1, std::min(own.fewest, size), std::max(own.most, size)};
  }
  for (const auto& [name, own] : families)
    std::printf("  %-20s %s, %td to %td unknowns\n", name.c_str(), counted(own.problems, "problem").c_str(), own.fewest,
                own.most);
  std::printf("%s runs, each with a limit of %s of CPU time%s\n", grouped(plan.size()).c_str(),
              duration(plan.time_limit).c_str(),
              plan.whole_suite && plan.limit_s > 0
                  ? (", shortened where all would not end within " + duration(plan.limit_s)).c_str()
                  : "");
  return done;
}

// dz by finite differences and of rows made soft, against proven derivatives (docs/tutorials/gradients.md).
int bench_gradients(const CLI::App& options, const Asked& asked) {
  for (const CLI::Option* option : options.get_options())
    if (option->count() > 0 && std::ranges::none_of(std::array{"gradients", "scenes", "law", "seed", "out"},
                                                    [&](const char* own) { return option->check_lname(own); }))
      throw std::invalid_argument("--gradients asks --scenes under --law: " + option->get_name() +
                                  " has no part in it");
  return compare_gradients({new_directory(asked.out, "").string(), std::to_string(asked.suite.seed),
                            words_of(asked.suite.laws), asked.suite.scenes});
}

}  // namespace

int bench_command(std::vector<std::string> words, CollisionSuite collision) {
  CLI::App options("Runs solvers on problems, checks every answer, writes results and a report.");
  introduce(options, "bench",
            "  ./zwang bench\n"
            "  ./zwang bench --suite quick --out first\n"
            "  ./zwang bench --scenes \"tower(boxes=10,100),hand(contacts=64,seed=1..5)\" \\\n"
            "                --solvers nnls,dual_active_set,ipopt --tolerances 1e-6,1e-10\n"
            "  ./zwang bench --problems rover/*.hdf5 --law pyramid --trace --out rover\n"
            "  ./zwang bench --suite atlas --families NPE,LOOP --solvers dual_active_set,cholesky\n"
            "  ./zwang bench --resume rover\n"
            "  ./zwang bench --suite quick --shard 0/4 --out part0      docs/campaigns.md\n"
            "  ./zwang bench --missing part0 part1 part2 part3\n"
            "  ./zwang bench --gradients --scenes \"hand(contacts=4..8)\" --law coulomb");
  Asked asked;
  add_options(options, asked);
  const std::string command = command_line("bench", words);
  const std::vector<std::string> typed = words;
  if (!words.empty() && std::ranges::find(suites(), words[0], &Suite::name) != suites().end())
    throw std::invalid_argument("'" + words[0] + "' is a suite: ./zwang bench --suite " + words[0]);
  if (!read(options, std::move(words))) return done;
  if (!asked.missing.empty()) {
    asked.missing.insert(asked.missing.begin(), "--missing");
    return merge_command(asked.missing);
  }
  if (asked.gradients) return bench_gradients(options, asked);
  if (asked.suite.suite == "collision") {
    if (!asked.suite.shard.empty()) throw std::invalid_argument("the collision suite takes minutes and has no parts");
    if (!asked.resume.empty()) throw std::invalid_argument("the collision suite takes minutes and is not resumed");
    return collision ? collision(new_directory(asked.out, ""), command) : continue_as_whole_program("bench", typed);
  }
  if (!asked.tolerances.empty()) asked.suite.tolerances = numbers("--tolerances", asked.tolerances);

  SuiteSettings settings;
  if (!asked.resume.empty()) {
    if (!asked.out.empty()) throw std::invalid_argument("--resume DIR writes into DIR: --out has no part in it");
    settings.directory = asked.resume;
    asked.suite = options_to_resume(settings.directory, asked.suite, [&](const std::string& name) {
      const CLI::Option* option = options.get_option_no_throw("--" + name);
      return option && option->count() > 0;
    });
  } else {
    settings.directory = new_directory(asked.out, "./zwang bench --resume");
  }
  settings.cache = reference_cache();
  settings.command = command;

  // scene -> assemble -> problem
  const Plan plan = asked.resume.empty()
                        ? make_plan(std::move(asked.suite))
                        : from_record(asked.resume, [&asked] { return make_plan(std::move(asked.suite)); });
  const Conditions c = conditions();
  const std::string runs = counted(plan.solvers(), "solver") + " x " + counted(plan.problems(), "problem") + " x " +
                           counted(plan.options.tolerances.size(), "tolerance");
  std::printf("zwang %s   %s: %s, seed %llu, one core%s\n", c.version.c_str(), plan.title().c_str(), runs.c_str(),
              static_cast<unsigned long long>(plan.options.seed),
              plan.shard.of > 1 ? (", part " + plan.options.shard).c_str() : "");
  if (c.debug) std::puts("THIS IS A DEBUG BUILD: its times mean nothing.");
  std::fflush(stdout);
  if (asked.plan) return print_plan(plan);

  // problem -> solve -> solution -> measure -> results
  const std::string directory = settings.directory.string();
  const bool whole = plan.options.shard.empty();  // merge writes the report of all parts
  if (whole) {
    std::printf("Report: %s/report.html (as results come)\n", directory.c_str());
    std::fflush(stdout);
    settings.between = [&directory, next = 0.0]() mutable { report_so_far(directory, next); };
  }
  const std::string go_on = "./zwang bench --resume " + report::shell_word(directory);
  const std::atomic<bool>& interrupted = stop_on_interrupt();
  Outcome outcome;
  try {
    outcome = run_suite(plan, settings, interrupted);
  } catch (const std::runtime_error& broken) {  // a full disk, a folder that is gone
    if (!holds_run(settings.directory)) throw;
    std::fprintf(stderr, "%s (finished runs are kept; go on with: %s)\n", broken.what(), go_on.c_str());
    return bad_file;
  }
  if (outcome.interrupted) {
    std::printf("Stopped after %s of %s runs; nothing lost. Go on with: %s\n", grouped(outcome.tally.runs).c_str(),
                grouped(outcome.planned).c_str(), go_on.c_str());
    return stopped;
  }
  std::printf("%s runs in %s%s: %s\n", grouped(outcome.tally.runs).c_str(), duration(outcome.seconds).c_str(),
              earlier(outcome).c_str(), counts(outcome.tally).c_str());
  for (const std::string& note : outcome.notes) std::printf("%s\n", note.c_str());

  if (!whole) return done;

  // results -> report
  return write_report({":end", directory});
}

}  // namespace zwang
