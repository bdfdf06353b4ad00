#pragma once

#include <zwang/bench/program/program.h>

namespace zwang {

Command::Run simulate_command, experiment_command, live_command, hand_command, capture_command;

// `bench --suite collision`.
int bench_collision(const std::filesystem::path& directory, const std::string& command);

// What scripts ask the program for: these print a line of JSON for each answer.
int frames_part(const std::vector<std::string>& words);
int collision_part(const std::vector<std::string>& words);

}  // namespace zwang
