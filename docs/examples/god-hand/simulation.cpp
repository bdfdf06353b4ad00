// A tracked hand comes down beside a box and slides into it: poses in; poses, forces and contacts out.
#include <cstdio>

#include <zwang/experiments/god_hand/scenes/scenes.h>
#include <zwang/experiments/god_hand/simulation.h>

using namespace zwang;

int main() {
  god::Target hand{.palm = {{0, 0, 0.08}, Mat3::Identity()}};
  god::Simulation simulation(god::make_surroundings("box", ""), std::span(&hand::standard(), 1), std::span(&hand, 1),
                             {.dt = 1e-3});
  for (int k = 1; k <= 600; ++k) {
    hand.palm.position += k <= 200 ? Vec3(0, 0, -4e-4) : Vec3(3e-4, 0, 0);
    const god::Frame& frame = simulation.step(std::span(&hand, 1));
    if (k % 100 > 0) continue;
    std::printf("%.1f s: palm at %.3f, %.3f m, %.1f N back, box at %.3f m, %zu contacts\n", frame.time,
                frame.god[0].position.x(), frame.god[0].position.z(), frame.device[0].head<3>().norm(),
                frame.loose[0].position.x(), frame.contacts.size());
  }
}
