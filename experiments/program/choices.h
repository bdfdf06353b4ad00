#pragma once

#include <string>

#include <zwang/experiments/god_hand/run/run.h>

namespace CLI {
class App;
}

namespace zwang {

// What is simulated and how, as `simulate` and `live` let people choose it.
struct Choices {
  god::Asked asked = {};
  double rate = 1000, seconds = 0;  // Hz; s of simulated time, 0: all there is
};

// Every choice as an option of `app`, and the names of scenes, god objects and motions at the end of its help.
void add_choices(CLI::App& app, const std::string& command, const std::string& examples, Choices& choices);

// Of `seconds`, at least one.
long frames_of(const Choices& choices);
// The record of a run by these choices, once they were read.
god::Record record_of(const CLI::App& app, const Choices& choices, const std::string& command_line);

// "grasp in box: 1 hand, ...", a line or two.
std::string head_line(const god::Record& record, const god::Setup& setup);

}  // namespace zwang
