// The program `zwang`. One flow runs through every command:
//
//   scene -> assemble -> problem -> solve -> solution -> measure -> metrics -> results.jsonl -> report
//
// `bench` walks all of it, `solve` from a stored problem to its metrics, `export` from a scene to a stored problem,
// `report` from stored results to charts. `simulate` walks it once a frame, for a hand among objects.

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "bench/suite/conditions.h"
#include "core/nearest.h"
#include "experiments/commands.h"

namespace {

const std::array commands = {
    zwang::Command{"bench", "Compare solvers", "run solvers on scenes or problem files, write results and a report",
                   zwang::bench_command},
    zwang::Command{"report", "Compare solvers",
                   "charts of stored results, as a page or for a paper; two runs side by side", zwang::report_command},
    zwang::Command{"fuzz", "Compare solvers", "small problems with exact answers: whose claims are not true",
                   zwang::fuzz_command},
    zwang::Command{"simulate", "The god hand", "a tracked hand among objects: frames, a summary, a replay in 3D",
                   zwang::simulate_command},
    zwang::Command{"experiment", "The god hand", "a question of the paper, answered by a run here",
                   zwang::experiment_command},
    zwang::Command{"hand", "The god hand", "the sparsity of its problem", zwang::hand_command},
    zwang::Command{"solve", "Look at one problem", "solve one problem file and say whether the answer is right",
                   zwang::solve_command},
    zwang::Command{"export", "Look at one problem", "write a scene's problem to a file", zwang::export_command},
    zwang::Command{"mesh", "Look at one mesh", "load a mesh file and say what is in it", zwang::mesh_command},
    zwang::Command{"scenes", "What there is", "the scenes and their knobs", zwang::scenes_command},
    zwang::Command{"solvers", "What there is", "the solvers, their settings, and what each cannot do",
                   zwang::solvers_command},
};

void print_help() {
  std::puts(
      "zwang compares solvers for Gauss' principle of least constraint (docs/formulation.md).\n\n"
      "Usage: ./zwang COMMAND [OPTIONS]     (./zwang COMMAND --help: its options, with examples)");
  std::string group;
  for (const zwang::Command& c : commands) {
    if (c.group != group) std::printf("\n%s:\n", c.group.c_str());
    group = c.group;
    std::printf("  %-10s %s\n", c.name.c_str(), c.line.c_str());
  }
  std::puts(
      "\nThe project itself:\n"
      "  setup      install what is needed and build\n"
      "  test       build and run the tests (./zwang test -R PATTERN: some of them)\n\n"
      "Examples:\n"
      "  ./zwang bench                    the standard suite, at most ten minutes\n"
      "  ./zwang bench --suite quick      a minute\n"
      "  ./zwang simulate simple --motion grasp\n"
      "  ./zwang solve results/20261120-2354/problems/0007.h5 --solver nnls\n\n"
      "Exit codes: 0 done, 1 fuzzing found a fault, 2 wrong use, 3 a file that cannot be used, 130 stopped with "
      "Ctrl-C.");
}

int run(const std::string& word, std::vector<std::string> rest) {
  std::vector<std::string> names = {"setup", "test"};
  for (const zwang::Command& c : commands) {
    if (c.name == word) return c.run(std::move(rest));
    names.push_back(c.name);
  }
  throw std::invalid_argument("no command '" + word + "'" + zwang::did_you_mean(word, names) +
                              " (./zwang --help lists all)");
}

}  // namespace

int main(int count, char** arguments) {
  // Before any library looks: one BLAS thread, since solvers are compared on one core.
  for (const char* name : {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"}) setenv(name, "1", 1);

  std::vector<std::string> words(arguments + 1, arguments + count);
  if (words.empty() || words[0] == "--help" || words[0] == "-h" || words[0] == "help") {
    print_help();
    return words.empty() ? zwang::wrong_use : zwang::done;
  }
  if (words[0] == "--version") {
    const zwang::Conditions c = zwang::conditions();
    std::printf("zwang %s (%s%s)\n", c.version.c_str(), c.commit.substr(0, 7).c_str(), c.dirty ? ", changed" : "");
    return zwang::done;
  }
  try {
    return run(words[0], {words.begin() + 1, words.end()});
  } catch (const std::filesystem::filesystem_error& bad) {
    std::fprintf(stderr, "%s: %s\n", bad.path1().c_str(), bad.code().message().c_str());
    return zwang::bad_file;
  } catch (const std::runtime_error& bad) {
    std::fprintf(stderr, "%s\n", bad.what());
    return zwang::bad_file;
  } catch (const std::invalid_argument& wrong) {
    std::fprintf(stderr, "%s\n", wrong.what());
    return zwang::wrong_use;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "out of memory\n");
    return zwang::bad_file;
  }
}
