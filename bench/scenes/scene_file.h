#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <zwang/bench/scenes/json_document.h>
#include <zwang/bench/scenes/physical.h>
#include <zwang/collision/shape.h>
#include <zwang/constraints/joint_limit.h>

namespace zwang {
namespace collision {
class Tree;
}

// A scene written down as JSON (docs/scene-files.md, docs/scene.schema.json): bodies, shapes, joints, limits, contacts,
// motion. Its problem is assembled as every scene's is. Throws BadFile with line and member.
Instance read_scene_file(const std::filesystem::path& file);

// What such a file says of bodies, joints and limits, and where: for other uses than its problem. JsonValue::fail()
// names line and member.
struct WrittenScene {
  struct Part {
    std::string name;
    std::optional<collision::Shape> shape;
    std::shared_ptr<const collision::Tree> mesh;
    JsonValue written;
  };
  struct Joint {
    std::string name, type;  // as in the file: "hinge"
    std::array<BodyId, 2> bodies;
    std::size_t item;  // its number in the scene's list of that type
    double drive;      // rad per rad; 0 where it has none
    JsonValue written;
  };

  std::shared_ptr<const JsonDocument> document;  // which the values below point into
  JsonValue root;
  Scene scene = {};
  std::vector<Part> parts = {};    // by body
  std::vector<Joint> joints = {};  // in the order of the file; of limits a scene's list says all
};
WrittenScene read_written_scene(const std::filesystem::path& file);

// Both sides of a hinge's range, the angle counted from where the bodies are. `axis`: unit, world. A range of a turn or
// more is none.
struct HingeRange {
  std::optional<double> low, high;  // rad
};
std::vector<JointLimit> hinge_limits(const Scene& scene, std::array<BodyId, 2> bodies, const Vec3& axis,
                                     const HingeRange& range);

}  // namespace zwang
