#pragma once

#include <zwang/bench/scenes/physical.h>
#include <zwang/constraints/contact.h>
#include <zwang/core/model/motion.h>

#include "on_wire.h"

// Beads on a tilted wire slide against a stop at its lower end, each pushing on the next.
inline zwang::Instance beads(const zwang::Knobs& knobs) {
  using namespace zwang;
  const int count = static_cast<int>(knobs.at("beads"));
  const double tilt = knobs.at("tilt"), radius = 0.125;  // m
  Draw draw(knobs.at("seed"));
  const Vec3 up(std::cos(tilt), 0, std::sin(tilt));  // along the wire
  Scene scene;
  const BodyId stop = add_fixed(scene);
  BodyId below = stop;
  for (int i = 0; i < count; ++i) {
    Body body;
    body.pose.position = (2 * i + 1) * radius * up;
    body.velocity << draw.uniform(-1, 0) * up, 0, 0, 0;  // m/s, down the wire
    const BodyId bead = scene.add(body);
    const std::string name = "bead " + std::to_string(i + 1);
    scene.add(OnWire{.bodies = {bead, stop}, .across = Vec3::UnitY(), .across_too = up.cross(Vec3::UnitY())}, name);
    scene.add(contact_at(scene.bodies, bead, below, body.pose.position - radius * up, up), name + " on the next");
    below = bead;
  }
  Vector z_u;
  move_freely(scene, gravity, {}, z_u);
  return to_instance(scene, z_u, {.dt = scene_dt, .mode = Mode::dynamic});
}

inline const zwang::SceneEntry beads_scene = {.name = "beads",
                                              .family = "beads",
                                              .line = "beads on a tilted wire, each pushing on the next",
                                              .sweep = "beads",
                                              .knobs = {{"beads", 10, 1, 1000, true, "number of beads"},
                                                        {"tilt", 0.5, 0, 1.5, false, "of the wire (rad)"},
                                                        {"seed", 1, 0, 1e9, true, "of the random draws"}},
                                              .make = beads};
