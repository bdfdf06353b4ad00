#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <zwang/bench/program/program.h>

namespace zwang {

// `collision`: runs that suite; null: the whole program does.
int bench_command(std::vector<std::string> words, CollisionSuite collision);
Command::Run solve_command, solvers_command, scenes_command, export_command, report_command, fuzz_command, mesh_command;
Command::Run conformance_command, campaign_command, merge_command, pack_command, solve_pack_command, judge_command;
Command::Run guard_command, league_command;

// `solve FILE --solutions`: looks for all solutions of Coulomb's law and prints what was proven, for people or as one
// JSON object. Throws std::invalid_argument where the question makes no sense of this problem.
void print_solutions(const Instance& instance, bool json);

// Goes on as another program, found as a shell finds it. Throws BadFile where it cannot be run.
int continue_as(const std::string& file, const std::vector<std::string>& words);
// Goes on as the last of these scripts (held.py), as main(before, this program, words). Throws likewise.
int continue_as_files(const std::vector<std::pair<std::string, std::string_view>>& files,
                      const std::vector<std::string>& words, const std::vector<std::string>& before = {});
// Writes the report of a run in a process of its own, by the words of report.py; returns its exit code.
int write_report(const std::vector<std::string>& words, bool silent = false);
// Goes on as the script behind bench --gradients: a folder, a seed, laws and scenes ("": its own).
int compare_gradients(const std::vector<std::string>& words);
// Goes on as the script that writes the verdicts of results.jsonl to `file` as JUnit's XML, which ends with `code`.
int write_junit(const std::filesystem::path& results, const std::string& file, int code);
// Goes on as zwang-all, the program with every command. Throws std::invalid_argument where it is not there.
int continue_as_whole_program(const std::string& word, const std::vector<std::string>& words);

}  // namespace zwang
