#include <CLI/CLI.hpp>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/packs/judge_pack.h>
#include <zwang/bench/packs/proofs.h>
#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/long_run.h>
#include <zwang/bench/program/options.h>
#include <zwang/bench/suite/progress.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

std::function<void(std::size_t, const std::string&)> progress_of(Progress& bar, std::size_t all) {
  return [&bar, all](std::size_t k, const std::string& name) {
    bar.show(static_cast<double>(k) / static_cast<double>(all), name);
  };
}

void print_missing(const Answers& answers, const Pack& pack) {
  if (answers.missing.empty()) return;
  std::printf("%s: no answer to %s of %zu problems, %s first\n", answers.file.c_str(),
              grouped(answers.missing.size()).c_str(), pack.problems().size(), answers.missing[0].c_str());
}

void print_proofs(const Pack& pack, const std::vector<Answers>& contestants, const std::filesystem::path& directory) {
  Progress bar;
  const ProofTally tally =
      write_proofs(pack, contestants, directory, progress_of(bar, pack.problems().size()), stop_on_interrupt());
  bar.clear();
  std::printf("%s proofs -> %s\n", grouped(tally.written).c_str(), directory.c_str());
  for (const auto& [reason, count] : tally.without)
    std::printf("no proof of %s answers: %s\n", grouped(count).c_str(), reason.c_str());
}

}  // namespace

int pack_command(std::vector<std::string> words) {
  CLI::App options("Writes problems for solvers of any origin: a folder of files with an index, or checks one.");
  std::string named;
  for (const NamedPack& pack : named_packs())
    named += "\n  " + pack.name + std::string(10 - pack.name.size(), ' ') + pack.line;
  introduce(options, "pack",
            "  ./zwang pack guard --out guard\n"
            "  ./zwang pack \"hand(contacts=4,16,seed=1..5)\" rover/Rover4396.dat --out mine\n"
            "  ./zwang pack guard --check\n"
            "Packs made from seeds:" +
                named);
  std::vector<std::string> what;
  std::string out;
  bool check = false;
  std::uint64_t seed = 1;
  options.add_option("WHAT", what, "a named pack, scenes, problem files or folders; with --check: a pack's folder")
      ->required();
  options.add_option("--out", out, "folder of the pack")->type_name("DIR");
  within(from(0), options.add_option("--seed", seed, "of every scene whose knobs do not say"));
  options.add_flag("--check", check, "read the whole pack and say whether files and index fit");
  if (!read(options, std::move(words))) return done;
  if (check) {
    if (what.size() != 1 || !out.empty())
      throw std::invalid_argument("--check takes one pack's folder and nothing else");
    const Pack pack(what[0]);
    pack.check();
    std::printf("%s: %zu problems, as its index says\n", what[0].c_str(), pack.problems().size());
    return done;
  }
  if (out.empty()) throw std::invalid_argument("--out DIR is required");
  if (std::filesystem::exists(std::filesystem::path(out) / "pack.json"))
    throw std::invalid_argument(out + " holds a pack already");
  std::vector<Instance> problems = problems_of_pack(what, seed);
  what.insert(what.end(), {"--seed", std::to_string(seed)});
  Progress bar;
  const std::size_t all = problems.size();
  write_pack(out, std::move(problems), command_line("pack", what), reference_cache(), progress_of(bar, all));
  bar.clear();
  std::printf("%zu problems -> %s\n", all, out.c_str());
  return done;
}

int solve_pack_command(std::vector<std::string> words) {
  CLI::App options("Solves every problem of a pack with one solver and writes its answers (docs/packs.md).");
  introduce(options, "solve-pack", "  ./zwang solve-pack guard --solver dual_active_set --out dual.jsonl");
  std::string directory, out;
  PackRun run;
  options.add_option("PACK", directory, "the pack's folder")->required();
  options.add_option("--solver", run.solver, "name, or name:key=value,... (./zwang solvers)")
      ->type_name("NAME")
      ->required();
  options.add_option("--out", out, "the file of answers")->type_name("FILE")->required();
  within(tolerances,
         options.add_option("--tolerance", run.tolerance, "relative, in the M-norm on unit rows; default: 1e-10"))
      ->type_name("T");
  within(above(0, "s"), options.add_option("--time-limit", run.time_limit, "CPU time of a problem; default: 10"))
      ->type_name("S");
  if (!read(options, std::move(words))) return done;
  make_solver(run.solver);
  const Pack pack(directory);
  const std::atomic<bool>& interrupted = stop_on_interrupt();
  Progress bar;
  const std::size_t solved = solve_pack(pack, run, out, progress_of(bar, pack.problems().size()), interrupted);
  bar.clear();
  std::printf("%s of %s answers -> %s\n", grouped(solved).c_str(), grouped(pack.problems().size()).c_str(),
              out.c_str());
  return interrupted ? stopped : done;
}

int judge_command(std::vector<std::string> words) {
  CLI::App options(
      "Judges answers to a pack: verdicts, proven distances, false claims, a report. Exit code 1: a false claim.");
  introduce(options, "judge", "  ./zwang judge guard mine.jsonl theirs.jsonl --out judged --junit judged.xml");
  std::string directory, out, junit, proofs;
  std::vector<std::string> files, names;
  options.add_option("PACK", directory, "the pack's folder")->required();
  options.add_option("ANSWERS", files, "files of answers (docs/packs.md), one a solver")->required();
  options.add_option("--out", out, "folder for the results; default: results/<date>-<time>")->type_name("DIR");
  options.add_option("--names", names, "what the solvers are called, with commas; default: as their files say")
      ->delimiter(',')
      ->type_name("A,B");
  options.add_option("--junit", junit, "also: a test case an answer, for continuous integration")->type_name("FILE");
  options
      .add_option("--proofs", proofs, "new folder: also a file an answer that proves how far it is from the true one")
      ->type_name("DIR");
  const std::string command = command_line("judge", words);
  if (!read(options, std::move(words))) return done;
  const Pack pack(directory);
  std::vector<Answers> contestants;
  if (!names.empty() && names.size() != files.size())
    throw std::invalid_argument("--names says " + std::to_string(names.size()) + " for " +
                                std::to_string(files.size()) + " files of answers");
  for (const std::string& file : files) {
    contestants.push_back(read_answers(file, pack));
    print_missing(contestants.back(), pack);
    if (!names.empty()) contestants.back().solver = names[contestants.size() - 1];
  }
  SuiteSettings settings{.directory = new_directory(out, ""), .cache = reference_cache(), .command = command};
  if (!proofs.empty()) print_proofs(pack, contestants, new_directory(proofs, ""));
  const Outcome outcome = judge_pack(pack, std::move(contestants), settings, stop_on_interrupt());
  if (outcome.interrupted) {
    std::puts("Stopped: no report.");
    return stopped;
  }
  const Tally& t = outcome.tally;
  const std::string unsupported = t.unsupported > 0 ? ", " + grouped(t.unsupported) + " unsupported" : "";
  std::printf("%s answers: %s right, %s near, %s wrong, %s failed, %s undecided%s; %s claimed falsely\n",
              grouped(t.runs).c_str(), grouped(t.solved).c_str(), grouped(t.near).c_str(), grouped(t.wrong).c_str(),
              grouped(t.failed).c_str(), grouped(t.undecided).c_str(), unsupported.c_str(), grouped(t.lies).c_str());
  if (const int code = write_report({settings.directory.string()}); code != done) return code;
  const Exit code = t.lies > 0 ? found : done;
  return junit.empty() ? code : write_junit(settings.directory / "results.jsonl", junit, code);
}

}  // namespace zwang
