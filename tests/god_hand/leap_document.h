#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/god_hand/motion/motions.h>
#include "tests/folders.h"

namespace zwang::god {

// A Leap recording of hands of the standard measures, both curling their fingers: what the tracker would have written.
inline nlohmann::json leap_document(int frames, bool right, bool left) {
  using Json = nlohmann::json;
  const auto mm = [](const Vec3& p) { return Json::array({1e3 * p.x(), 1e3 * p.z(), -1e3 * p.y()}); };
  const auto axis = [](const Vec3& v) { return Json::array({v.x(), v.z(), -v.y()}); };
  Json document = {{"metadata", {{"formatVersion", 2}}}, {"frames", Json::array()}};
  document["frames"].push_back(Json::parse(R"(["id", "timestamp",
    {"hands": [["id", "type", "direction", "palmNormal", "palmPosition"]]},
    {"pointables": [["id", "handId", "tool", "carpPosition", "mcpPosition", "pipPosition", "dipPosition", "btipPosition"]]}])"));
  for (int n = 0; n < frames; ++n) {
    Json hands = Json::array(), fingers = Json::array();
    for (const bool is_left : {false, true}) {
      if (is_left ? !left : !right) continue;
      const hand::Model model = is_left ? hand::mirrored(hand::standard()) : hand::standard();
      Pose<double> palm{Vec3(is_left ? -0.1 : 0.1, 0, 0.2 - 0.001 * n), Mat3::Identity()};
      palm = retract(palm, Vec<double, 6>(Vec<double, 6>::Unit(4) * 0.01 * n));
      hand::Angles angles;
      for (std::size_t a = 0; a < angles.size(); ++a) {
        const hand::Range r = model.range(static_cast<int>(a));
        const double s = 0.5 + 0.45 * std::sin(0.1 * n + 0.7 * static_cast<double>(a));
        angles[a] = r.low + s * (r.high - r.low);
      }
      const hand::Poses poses = hand::forward_kinematics(palm, angles, model);
      const int id = is_left ? 8 : 7;
      hands.push_back({id, is_left ? "left" : "right", axis(palm.rotation.col(1)), axis(-palm.rotation.col(2)),
                       mm(palm * Vec3(0, 0.005, 0))});
      for (int f = 0; f < 5; ++f) {
        const auto bone = [&](int k, double end) {
          const auto b = static_cast<std::size_t>(1 + 3 * f + k);
          return mm(poses[b] * Vec3(0, end * model.phalanx(static_cast<int>(b)).length / 2, 0));
        };
        const Json base = bone(0, -1);
        fingers.push_back({10 * id + f, id, false, base, base, bone(0, 1), bone(1, 1), bone(2, 1)});
      }
    }
    document["frames"].push_back({n, 1000000 + 17500 * n + 300 * (n % 3), hands, fingers});
  }
  return document;
}

// A file of this text in a folder of its own; the name may have folders' characters.
inline std::filesystem::path written(const std::string& name, const std::string& text) {
  const std::filesystem::path folder = own_path("motions");
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name, std::ios::binary) << text;
  return folder / name;
}

// The line that reading a motion of this text throws; "" where it is read.
inline std::string motion_refusal(const std::string& text, const std::string& name) {
  try {
    read_motion(written(name, text));
  } catch (const BadFile& bad) {
    return bad.what();
  }
  return {};
}

}  // namespace zwang::god
