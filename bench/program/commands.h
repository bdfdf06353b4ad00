#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include <zwang/bench/program/program.h>

namespace zwang {

// `collision_hands`: those of the suite `collision`; null: none.
int bench_command(std::vector<std::string> words, std::vector<HandScene> (*collision_hands)());
int solve_command(std::vector<std::string> words);
int solvers_command(std::vector<std::string> words);
int scenes_command(std::vector<std::string> words);
int export_command(std::vector<std::string> words);
int capture_command(std::vector<std::string> words);
int report_command(std::vector<std::string> words);
int fuzz_command(std::vector<std::string> words);
int conformance_command(std::vector<std::string> words);
int merge_command(std::vector<std::string> words);
int campaign_command(std::vector<std::string> words);
int mesh_command(std::vector<std::string> words);

// What `merge` does, and a campaign at its end: joins, prints what was found, writes the report.
int merge_and_report(const std::vector<std::filesystem::path>& parts, const std::filesystem::path& out,
                     const std::string& command);

// Throws std::invalid_argument unless these words of `bench` say what is run, and that can be dealt out to parts.
void require_suite(std::vector<std::string> words);

// `bench --suite collision`.
int bench_collision(const std::filesystem::path& directory, const std::string& command, std::vector<HandScene> hands,
                    const std::atomic<bool>& interrupted);

}  // namespace zwang
