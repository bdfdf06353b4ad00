#include <zwang/experiments/god_hand/scenes/site.h>

#include <limits>
#include <stdexcept>

namespace zwang::god {

// The way out is the one along which the distance grows; up, where that is as good as any.
Site::Site(const Surroundings& surroundings) : about(surroundings), depth(surroundings), focus(about.focus) {
  double most = -1;
  for (const Vec3& way : {Vec3(0, 0, 1), Vec3(0, -1, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(1, 0, 0)})
    if (const double gap = depth.distance(focus + 0.03 * way, 0.04); gap > most + 0.004) {
      most = gap;
      out = way;
    }
  along = out.z() > 0.5 ? Vec3::UnitY() : Vec3::UnitZ();
  aside = along.cross(out);
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < about.objects.size(); ++k)
    if (const double gap = depth.distance(focus, k, 1); gap < nearest - 1e-6) {
      nearest = gap;
      object = k;
    }
}

Mat3 Site::axes(const Vec3& fingers, const Vec3& back) {
  return (Mat3() << fingers.cross(back), fingers, back).finished();
}

Pose<double> Site::flat(double height, double forth, double sideways) const {
  const double half = hand::standard().palm_widths.z() / 2;
  return {focus + (height + half) * out + forth * along + sideways * aside, axes(along, out)};
}

bool Site::clear(const Pose<double>& palm, const hand::Angles& angles, const hand::Model& model) const {
  return depth.of(hand::forward_kinematics(palm, angles, model), of_hand, 0.01) <= -0.01;
}

double Site::clear_height(double least, const std::function<Pose<double>(double)>& place, const hand::Angles& angles,
                          const hand::Model& model) const {
  for (double height = least; height < least + 1; height += 0.01)
    if (clear(place(height), angles, model)) return height;
  throw std::invalid_argument("no place clear of the objects near the focus of " + about.name);
}

double Site::solid_way(const Vec3& from, const Vec3& axis) const {
  constexpr double step = 0.001;
  double way = step;
  while (way < 0.15 && depth.distance(from + way * axis, object, step) < 0) way += step;
  return way;
}

std::array<double, 2> Site::extent(const Vec3& axis) const {
  const Object& o = about.objects[object];
  std::array<double, 2> range{infinity, -infinity};
  const auto take = [&](const Vec3& p, double radius) {
    range[0] = std::min(range[0], axis.dot(o.pose * p) - radius);
    range[1] = std::max(range[1], axis.dot(o.pose * p) + radius);
  };
  if (o.mesh && !o.loose())
    for (const collision::Triangle& t : o.mesh->triangles())
      for (const Vec3& corner : t.corner) take(corner, 0);
  for (const Object::Piece& piece : o.pieces)
    for (const Vec3& corner : piece.shape.corners()) take(piece.at * corner, piece.shape.radius());
  return range;
}

Vec3 Site::middle() const {
  Vec3 m = Vec3::Zero();
  for (const Vec3& axis : {out, along, aside}) m += (extent(axis)[0] + extent(axis)[1]) / 2 * axis;
  return m;
}

}  // namespace zwang::god
