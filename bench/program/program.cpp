// One flow runs through every command:
//
//   scene -> assemble -> problem -> solve -> solution -> measure -> metrics -> results.jsonl -> report
//
// `bench` walks all of it, `solve` from a stored problem to its metrics, `export` from a scene to a stored problem,
// `report` from stored results to charts.
#include <zwang/bench/program/program.h>

#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <span>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/timing/conditions.h>
#include <zwang/bench/timing/instruction_set.h>
#include <zwang/core/problem/wording.h>
#include <zwang/core/process/other_program.h>
#include <zwang/solvers/linalg/library_memory.h>

namespace zwang {
namespace {

// Of commands.def.
struct Word {
  std::string_view name, program, group, line;
};
constexpr std::array words_of_zwang = {
#define COMMAND(word, program, group, line) Word{#word, #program, group, line},
#include <zwang/bench/program/commands.def>
#undef COMMAND
};

std::vector<Command> own_commands(const Extensions& extensions) {
  return {{"bench", [collision = extensions.collision](
                        std::vector<std::string> words) { return bench_command(std::move(words), collision); }},
          {"report", report_command},
          {"campaign", campaign_command},
          {"merge", merge_command},
          {"pack", pack_command},
          {"solve-pack", solve_pack_command},
          {"judge", judge_command},
          {"guard", guard_command},
          {"league", league_command},
          {"fuzz", fuzz_command},
          {"conformance", conformance_command},
          {"solve", solve_command},
          {"export", export_command},
          {"mesh", mesh_command},
          {"scenes", scenes_command},
          {"solvers", solvers_command}};
}

// Those of commands.def, then the host's own. Where this program does not hold a command, zwang-all does.
std::vector<Command> all_commands(const Extensions& extensions) {
  std::vector<Command> given = own_commands(extensions), all;
  given.insert(given.end(), extensions.commands.begin(), extensions.commands.end());
  for (const Word& word : words_of_zwang) {
    if (word.program == "script") continue;
    const std::string name(word.name);
    const auto own = std::ranges::find(given, name, &Command::name);
    all.push_back(
        {name,
         own != given.end()
             ? own->run
             : [name](const std::vector<std::string>& words) { return continue_as_whole_program(name, words); },
         std::string(word.group), std::string(word.line)});
    if (own != given.end()) given.erase(own);
  }
  std::ranges::move(given, std::back_inserter(all));
  return all;
}

void print_help(std::span<const Command> commands) {
  std::puts(
      "zwang compares solvers for Gauss' principle of least constraint (docs/formulation.md).\n\n"
      "Usage: ./zwang COMMAND [OPTIONS]     (./zwang COMMAND --help: its options, with examples)");
  std::string group;
  for (const Command& c : commands) {
    if (c.group != group) std::printf("\n%s:\n", c.group.c_str());
    group = c.group;
    std::printf("  %-11s %s\n", c.name.c_str(), c.line.c_str());
  }
  for (const Word& word : words_of_zwang) {
    if (word.program != "script") continue;
    if (word.group != group) std::printf("\n%s:\n", (group = word.group).c_str());
    std::printf("  %-11s %s\n", word.name.data(), word.line.data());
  }
  std::puts(
      "\nExamples:\n"
      "  ./zwang bench                    the standard suite, at most ten minutes\n"
      "  ./zwang bench --suite quick      a minute\n"
      "  ./zwang simulate simple --motion grasp\n"
      "  ./zwang solve results/20261120-2354/problems/0007.h5 --solver nnls\n\n"
      "Exit codes: 0 done; 1 a fault was found (fuzz, conformance, judge, guard, solve --check), or\n"
      "runs are missing or disagree; 2 wrong use; 3 a file that cannot be used; 130 stopped with Ctrl-C.");
}

int run(std::span<const Command> commands, const std::string& word, std::vector<std::string> rest) {
  if (const auto known = std::ranges::find(commands, word, &Command::name); known != commands.end())
    return known->run(std::move(rest));
  std::vector<std::string> names = names_of(commands, &Command::name);
  for (const Word& known : words_of_zwang) {
    if (known.program != "script") continue;
    if (known.name == word)
      throw std::invalid_argument("'" + word + "' is for the script ./zwang in zwang's sources, not for this program");
    names.emplace_back(known.name);
  }
  throw std::invalid_argument("no command '" + word + "'" + did_you_mean(word, names) + " (./zwang --help lists all)");
}

}  // namespace

int continue_as(const std::string& file, const std::vector<std::string>& words) {
  std::vector<const char*> arguments = {file.c_str()};
  for (const std::string& word : words) arguments.push_back(word.c_str());
  arguments.push_back(nullptr);
  execvp(file.c_str(), const_cast<char**>(arguments.data()));
  throw std::runtime_error(file + ": " + std::strerror(errno));
}

int continue_as_whole_program(const std::string& word, const std::vector<std::string>& words) {
  const std::string file = find_program("zwang-all").string();
  if (file.empty())
    throw std::invalid_argument("'" + word + "' is a command of zwang-all, which is not built: ./zwang setup all");
  std::vector<std::string> all = {word};
  all.insert(all.end(), words.begin(), words.end());
  return continue_as(file, all);
}

int program(int count, char** arguments, const Extensions& extensions) {
  check_instruction_set();
  const std::vector<Command> commands = all_commands(extensions);
  // Before any library looks: one BLAS thread, since solvers are compared on one core.
  for (const char* name : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"}) setenv(name, "1", 1);

  LibraryMemory::install();  // solvers are timed in second solves, which then allocate nothing

  std::vector<std::string> words(arguments + 1, arguments + count);
  if (words.empty() || words[0] == "--help" || words[0] == "-h" || words[0] == "help") {
    print_help(commands);
    return words.empty() ? wrong_use : done;
  }
  if (words[0] == "--version") {
    const Conditions c = conditions();
    std::printf("zwang %s (%s%s)\n", c.version.c_str(), c.commit.substr(0, 7).c_str(), c.dirty ? ", changed" : "");
    return done;
  }
  try {
    for (const SolverEntry& entry : extensions.solvers) add_solver(entry);
    for (const SceneEntry& entry : extensions.scenes) add_scene(entry);
    const int code = run(commands, words[0], {words.begin() + 1, words.end()});
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
    std::fputs("standard output: cannot be written\n", stderr);
    return bad_file;
  } catch (const std::filesystem::filesystem_error& bad) {
    std::fprintf(stderr, "%s: %s\n", bad.path1().c_str(), bad.code().message().c_str());
    return bad_file;
  } catch (const std::invalid_argument& wrong) {
    std::fprintf(stderr, "%s\n", wrong.what());
    return wrong_use;
  } catch (const std::bad_alloc&) {
    std::fputs("out of memory\n", stderr);
    return bad_file;
  } catch (const std::exception& bad) {  // BadFile, and what a library throws over a file
    std::fprintf(stderr, "%s\n", bad.what());
    return bad_file;
  }
}

}  // namespace zwang
