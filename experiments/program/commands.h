#pragma once

#include <string>
#include <vector>

namespace zwang {

int simulate_command(std::vector<std::string> words);
int experiment_command(std::vector<std::string> words);
int live_command(std::vector<std::string> words);
int hand_command(std::vector<std::string> words);

}  // namespace zwang
