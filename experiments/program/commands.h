#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace zwang {

int simulate_command(std::vector<std::string> words);
int experiment_command(std::vector<std::string> words);
int live_command(std::vector<std::string> words);
int hand_command(std::vector<std::string> words);
int capture_command(std::vector<std::string> words);

// `bench --suite collision`.
int bench_collision(const std::filesystem::path& directory, const std::string& command);

// What scripts ask the program for: these print a line of JSON for each answer.
int frames_part(const std::vector<std::string>& words);
int collision_part(const std::vector<std::string>& words);

}  // namespace zwang
