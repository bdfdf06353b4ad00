// The program `zwang`: bench/program/ and the god hand, which walks the same flow once a frame.
#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/program.h>
#include <zwang/bench/scenes/recorded_data.h>
#include <zwang/experiments/god_hand/run/collision_scenes.h>
#include <zwang/experiments/program/commands.h>

int main(int count, char** arguments) {
  return zwang::program(
      count, arguments,
      {.commands = {{"simulate", "The god hand", "a tracked hand among objects: frames, a summary, a replay in 3D",
                     zwang::simulate_command},
                    {"live", "The god hand", "in real time: poses in; poses, forces and contacts out, over a socket",
                     zwang::live_command},
                    {"experiment", "The god hand", "a question of the paper, answered by a run here",
                     zwang::experiment_command},
                    {"hand", "The god hand", "the sparsity of its problem", zwang::hand_command}},
       .collision_hands = [] { return zwang::god::collision_scenes(zwang::recorded_data()); }});
}
