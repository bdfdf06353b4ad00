// One flow runs through every command:
//
//   scene -> assemble -> problem -> solve -> solution -> measure -> metrics -> results.jsonl -> report
//
// `bench` walks all of it, `solve` from a stored problem to its metrics, `export` from a scene to a stored problem,
// `report` from stored results to charts.
#include <zwang/bench/program/program.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <span>
#include <stdexcept>

#include <zwang/bench/program/commands.h>
#include <zwang/bench/timing/conditions.h>
#include <zwang/bench/timing/instruction_set.h>
#include <zwang/core/problem/did_you_mean.h>
#include <zwang/solvers/linalg/library_memory.h>

namespace zwang {
namespace {

const std::array own_commands = {
    Command{"report", "Compare solvers", "charts of stored results, as a page or for a paper; two runs side by side",
            report_command},
    Command{"campaign", "Compare solvers", "a suite in many tasks: Slurm, GNU parallel, or this machine",
            campaign_command},
    Command{"merge", "Compare solvers", "join the parts of a suite (bench --shard) into one run", merge_command},
    Command{"fuzz", "Compare solvers", "small problems with exact answers: whose claims are not true", fuzz_command},
    Command{"conformance", "Compare solvers", "one solver on phenomena of friction with exact answers",
            conformance_command},
    Command{"solve", "Look at one problem", "solve one problem file and say whether the answer is right",
            solve_command},
    Command{"capture", "Look at one problem", "step a MuJoCo model (MJCF, URDF) and write the problem of each step",
            capture_command},
    Command{"export", "Look at one problem", "write a scene's problem to a file", export_command},
    Command{"mesh", "Look at one mesh", "load a mesh file and say what is in it", mesh_command},
    Command{"scenes", "What there is", "the scenes and their knobs", scenes_command},
    Command{"solvers", "What there is", "the solvers, their settings, and what each cannot do", solvers_command},
};

// The extensions' commands behind the comparison's.
std::vector<Command> all_commands(const Extensions& extensions) {
  const auto bench = [hands = extensions.collision_hands](std::vector<std::string> words) {
    return bench_command(std::move(words), hands);
  };
  std::vector<Command> all(own_commands.begin(), own_commands.end());
  all.insert(all.begin(),
             {"bench", all[0].group, "run solvers on scenes or problem files, write results and a report", bench});
  const auto behind = std::ranges::find_if(all, [&](const Command& c) { return c.group != all[0].group; });
  all.insert(behind, extensions.commands.begin(), extensions.commands.end());
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
  std::puts(
      "\nThe project itself:\n"
      "  setup       install what is needed and build\n"
      "  test        build and run the tests (./zwang test -R PATTERN: some of them)\n"
      "  python      build the Python module, say how to import it\n"
      "  docs        build the pages and the API reference as a site that opens offline\n\n"
      "Examples:\n"
      "  ./zwang bench                    the standard suite, at most ten minutes\n"
      "  ./zwang bench --suite quick      a minute\n"
      "  ./zwang simulate simple --motion grasp\n"
      "  ./zwang solve results/20261120-2354/problems/0007.h5 --solver nnls\n\n"
      "Exit codes: 0 done; 1 fuzz or conformance found a fault, or runs are missing or disagree; 2 wrong use; 3 a file "
      "that cannot be used; 130 stopped with Ctrl-C.");
}

int run(std::span<const Command> commands, const std::string& word, std::vector<std::string> rest) {
  std::vector<std::string> names = {"setup", "test", "python", "docs"};
  for (const Command& c : commands) {
    if (c.name == word) return c.run(std::move(rest));
    names.push_back(c.name);
  }
  throw std::invalid_argument("no command '" + word + "'" + did_you_mean(word, names) + " (./zwang --help lists all)");
}

}  // namespace

int program(int count, char** arguments, const Extensions& extensions) {
  check_instruction_set();
  const std::vector<Command> commands = all_commands(extensions);
  // Before any library looks: one BLAS thread, since solvers are compared on one core.
  for (const char* name : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"}) setenv(name, "1", 1);

  LibraryMemory::install();  // solvers are timed in second solves, which then allocate nothing

  for (const SolverEntry& entry : extensions.solvers) add_solver(entry);
  for (const SceneEntry& entry : extensions.scenes) add_scene(entry);

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
    return run(commands, words[0], {words.begin() + 1, words.end()});
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
