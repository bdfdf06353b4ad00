// The program `zwang-all`: every command, the god hand's too, which walks the same flow once a frame.
#include <zwang/bench/program/program.h>
#include <zwang/experiments/program/commands.h>

int main(int count, char** arguments) {
  return zwang::program(count, arguments,
                        {.commands = {{"capture", zwang::capture_command},
                                      {"simulate", zwang::simulate_command},
                                      {"live", zwang::live_command},
                                      {"experiment", zwang::experiment_command},
                                      {"hand", zwang::hand_command}},
                         .collision = zwang::bench_collision});
}
