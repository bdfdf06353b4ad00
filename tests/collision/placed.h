#pragma once

#include <zwang/collision/world.h>

namespace zwang::collision {

inline std::shared_ptr<const Tree> tree(const Mesh& mesh) { return std::make_shared<const Tree>(mesh); }

inline Pose<double> at(const Vec3& position, const Vec3& turned = Vec3::Zero()) { return {position, rotation(turned)}; }

}  // namespace zwang::collision
