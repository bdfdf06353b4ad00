#pragma once

#include <memory>

#include <zwang/collision/shape.h>
#include <zwang/collision/tree.h>

namespace zwang {

// Bullet's convexSweepTest of a sphere or capsule against a mesh, in double precision, as a rival. Translation and the
// turn between two poses, as Bullet takes them.
class BulletSweep {
 public:
  explicit BulletSweep(const collision::Tree& mesh);
  ~BulletSweep();

  double time(const collision::Shape& shape, const Pose<double>& from, const Pose<double>& to) const;

 private:
  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace zwang
