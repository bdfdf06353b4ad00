#pragma once

#include <memory>
#include <vector>

#include <zwang/core/problem/types.h>

namespace zwang::collision {

// Axis-aligned boxes in the world and which of them a box meets, on FCL's dynamic AABB tree. Boxes are numbered in the
// order they are added.
class BroadPhase {
 public:
  BroadPhase();
  ~BroadPhase();
  BroadPhase(BroadPhase&&) noexcept;
  BroadPhase& operator=(BroadPhase&&) noexcept;

  void add(const Vec3& low, const Vec3& high);
  void move(int box, const Vec3& low, const Vec3& high);
  // Writes the boxes that meet [low, high], in rising order.
  void query(const Vec3& low, const Vec3& high, std::vector<int>& met);

 private:
  struct Boxes;
  std::unique_ptr<Boxes> boxes_;
};

}  // namespace zwang::collision
