#include <zwang/bench/engines/adapters/protocol.h>

#include <unistd.h>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

namespace zwang::engines {
namespace {

using nlohmann::json;

Scene scene_of(const json& text, bool tuned) {
  Scene scene;
  scene.dt = text["dt"], scene.mu = text["mu"], scene.restitution = text["restitution"];
  scene.gravity = text["gravity"], scene.mjcf = text.value("mjcf", ""), scene.tuned = tuned;
  for (const json& b : text["bodies"]) {
    Body& body = scene.bodies.emplace_back();
    body.motion = b["motion"], body.mass = b["mass"], body.inertia = b["inertia"];
    body.at = b["at"], body.turn = b["turn"], body.velocity = b["velocity"], body.spin = b["spin"];
    body.force = b["force"], body.torque = b["torque"];
    for (const json& s : b["shapes"])
      body.shapes.push_back({s["kind"], s["at"], s.value("half", Triple{}), s.value("radius", 0.0)});
  }
  for (const json& j : text["joints"]) scene.joints.push_back({j["a"], j["b"], j["at"]});
  return scene;
}

json states_of(const World& world) {
  json states = json::array();
  for (int i = 0; i < world.scene.size(); ++i) states.push_back(world.state(i));
  return {{"states", states}};
}

}  // namespace

int serve(const Hello& hello, const std::function<std::unique_ptr<World>(const Scene&)>& make) {
  // Engines that talk do so on stderr: stdout is the protocol's.
  const int copy = dup(STDOUT_FILENO);
  std::FILE* out = copy >= 0 ? fdopen(copy, "w") : nullptr;
  if (!out) return 1;
  if (dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
    std::fclose(out);
    return 1;
  }
  const auto say = [&](const json& answer) {
    std::fprintf(out, "%s\n", answer.dump().c_str());
    std::fflush(out);
  };
  say({{"engine", hello.engine},
       {"version", hello.version},
       {"licence", hello.licence},
       {"bits", hello.bits},
       {"order", hello.order},
       {"mjcf", hello.mjcf},
       {"alone", hello.alone},
       {"lacks", hello.lacks},
       {"substeps", {{"default", hello.substeps[0]}, {"tuned", hello.substeps[1]}}}});
  std::unique_ptr<World> world;
  for (std::string line; std::getline(std::cin, line);) {
    const json ask = json::parse(line);
    try {
      if (ask.contains("scene")) {
        world.reset();
        world = make(scene_of(ask["scene"], ask["setting"] == "tuned"));
      } else {
        for (int k = ask["step"]; k > 0; --k) world->step();
      }
      say(states_of(*world));
    } catch (const std::exception& error) {
      say({{"error", error.what()}});
    }
  }
  std::fclose(out);
  return 0;
}

}  // namespace zwang::engines
