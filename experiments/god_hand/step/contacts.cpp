#include <zwang/experiments/god_hand/step/contacts.h>

#include <algorithm>
#include <utility>

#include <zwang/core/problem/mix_bits.h>

namespace zwang::god {
namespace {

using collision::Core;
using collision::Filter;
using collision::Shape;
using collision::Touch;

constexpr double stop_distance = 1e-4;  // m: of the sweeps
constexpr Filter object_filter{std::uint64_t{1} << 63, ~std::uint64_t{0}};
constexpr std::size_t most_planes = 4;          // of a sphere against one mesh
constexpr double small_lift = 2e-8;             // m
constexpr double rounding = 1e-9;               // m
constexpr double completion_tolerance = 1e-12;  // m
const Shape point = Shape::sphere(1);

std::uint64_t key_of(const Touch& t, std::uint64_t kind, std::uint64_t number) {
  return mix_bits(mix_bits(mix_bits(kind + 1) + static_cast<std::uint64_t>(t.a)) ^
                  static_cast<std::uint64_t>(t.b) << 32 ^ number);
}

// A god object's sphere at `center` against the point `q` of b, or against its sphere of radius `thick` there.
Touch touch_of(int a, int b, const Vec3& center, double radius, const Vec3& q, double thick = 0) {
  const double distance = (center - q).norm();
  const Vec3 n = (center - q) / distance;
  return {.a = a,
          .b = b,
          .gap = distance - radius - thick,
          .normal = n,
          .point_a = center - radius * n,
          .point_b = q + thick * n};
}

Vec3 into(const Pose<double>& axes, const Vec3& p) { return axes.rotation.transpose() * (p - axes.position); }

}  // namespace

Contacts::Contacts(const GodObjects& objects, const Surroundings& surroundings) : world_({.stop = stop_distance}) {
  for (std::size_t b = 0; b < objects.shapes.size(); ++b)
    world_.add(objects.shapes[b], objects.scene.bodies[b].pose, objects.filters[b]);
  choose_corners(objects);
  scenery_ = Scenery(world_, surroundings, [](const Object&) { return Scenery::Role{object_filter}; });
  motion_.assign(at(world_.size()), Vec<double, 6>::Zero());
}

// A corner that coincides with a thicker one, or an earlier one as thick, of a body that it does not meet (at a
// finger's joint) moves with that one, whose rows imply its own: it has none.
void Contacts::choose_corners(const GodObjects& objects) {
  const auto place = [&](std::size_t b, const Vec3& corner) { return Vec3(objects.scene.bodies[b].pose * corner); };
  const auto said_by = [&](std::size_t b, const Vec3& corner) {
    for (std::size_t other = 0; other < objects.shapes.size(); ++other) {
      const double less = objects.shapes[other].radius() - objects.shapes[b].radius();
      if (other == b || less < 0 || (less == 0 && other > b) ||
          (objects.filters[b].mask & objects.filters[other].group) != 0)
        continue;
      for (const Vec3& theirs : objects.shapes[other].corners())
        if ((place(other, theirs) - place(b, corner)).norm() < 1e-9) return static_cast<BodyId>(other);
    }
    return static_cast<BodyId>(b);
  };
  for (std::size_t b = 0; b < objects.shapes.size(); ++b) {
    corners_.emplace_back();
    for (const Vec3& corner : objects.shapes[b].corners()) corners_[b].push_back({corner, said_by(b, corner)});
  }
}

void Contacts::find_rows(double activation, Choice choice) {
  const Touches touches = world_.touches(activation);
  raw_ = touches.size();
  rows_.clear();
  left_.clear();
  for (std::size_t first = 0, end = 0; first < touches.size(); first = end) {
    while (end < touches.size() && touches[end].a == touches[first].a && touches[end].b == touches[first].b) ++end;
    if (choice == Choice::raw)
      left_.insert(left_.end(), touches.begin() + static_cast<long>(first), touches.begin() + static_cast<long>(end));
    else
      meet(touches.subspan(first, end - first), activation);
  }
  as_row_ = left_;
  foot_ = {};
  made_.assign(left_.size(), 0);
  manifold_.reduce(left_, choice != Choice::few);
  add_kept(0, choice == Choice::raw);
}

// One pair of colliders.
void Contacts::meet(Touches touches, double activation) {
  const std::size_t first = rows_.size();
  const auto [a, b] = std::pair(touches[0].a, touches[0].b);
  if (world_.mesh(b) != nullptr)
    for (std::size_t corner = 0; corner < corners_[at(a)].size(); ++corner) meet_mesh(a, corner, b, activation);
  else
    meet_shape(a, b, activation);
  find_planes(a, b, first, activation);
  for (const Touch& t : touches)
    if (std::none_of(planes_.begin(), planes_.end(), [&](const collision::Plane& p) { return p.hides(t.point_b); }))
      left_.push_back(t);
}

void Contacts::meet_mesh(int a, std::size_t corner, int b, double activation) {
  const Corner& mine = corners_[at(a)][corner];
  if (mine.said_by != a) return;
  const Pose<double>& mesh = world_.pose(b);
  const double radius = world_.shape(a)->radius();
  const Vec3 center = world_.pose(a) * mine.at, local = into(mesh, center);
  std::array<collision::Plane, most_planes> planes;
  for (std::size_t k = 0; k < most_planes; ++k) {
    const auto found = nearest(*world_.mesh(b), local, radius + activation, std::span(planes).first(k));
    if (!found || !(found->distance > 0)) return;
    const Touch t = touch_of(a, b, center, radius, mesh * found->point);
    planes[k].normal = mesh.rotation.transpose() * t.normal;
    planes[k].offset = planes[k].normal.dot(found->point);
    add_row({t, key_of(t, corner, k), small_lift * static_cast<double>(corner)});
  }
}

// The corners of each against the other. (Of `point`, closest() looks at the core.)
void Contacts::meet_shape(int a, int b, double activation) {
  const Shape &mine = *world_.shape(a), &theirs = *world_.shape(b);
  const Pose<double>&at_a = world_.pose(a), &at_b = world_.pose(b);
  const double apart = mine.radius() + theirs.radius();
  const std::vector<Corner>& corners = corners_[at(a)];
  for (std::size_t corner = 0; corner < corners.size(); ++corner) {
    if (corners[corner].said_by != a) continue;
    const Vec3 center = at_a * corners[corner].at;
    const collision::Closest c =
        collision::closest(point, {into(at_b, center), Mat3::Identity()}, {.shape = &theirs}, 0);
    if (c.distance <= 0 || c.distance - apart > activation) continue;
    const Touch t = touch_of(a, b, center, mine.radius(), at_b * c.on_b, theirs.radius());
    add_row({t, key_of(t, corner, 0), small_lift * static_cast<double>(corner)});
  }
  const std::span<const Vec3> others = theirs.corners();
  for (std::size_t corner = 0; corner < others.size(); ++corner) {
    const Vec3 center = at_b * others[corner];
    const collision::Closest c = collision::closest(point, {into(at_a, center), Mat3::Identity()}, {.shape = &mine}, 0);
    if (c.distance <= 0 || c.distance - apart > activation) continue;
    const Touch seen = touch_of(b, a, center, theirs.radius(), at_a * c.on_b, mine.radius());
    const Touch t{a, b, 0, seen.gap, -seen.normal, seen.point_b, seen.point_a};
    add_row({t, key_of(t, corners.size() + corner, 0), small_lift * static_cast<double>(corner + 8)});
  }
}

// The planes of a pair's rows from which every corner keeps its distance, by a row or by being far from it. The god
// object then keeps it from everything below such a plane.
void Contacts::find_planes(int a, int b, std::size_t first_row, double activation) {
  const Pose<double>& pose = world_.pose(a);
  const double radius = world_.shape(a)->radius();
  const std::vector<Corner>& corners = corners_[at(a)];
  const auto keeps_off = [&](const Corner& corner, const Vec3& n, const Vec3& p) {
    const Vec3 center = pose * corner.at;
    const double height = n.dot(center - p) - radius, thick = world_.shape(corner.said_by)->radius();
    return height > activation || std::any_of(rows_.begin(), rows_.end(), [&](const Row& row) {
             const Touch& t = row.touch;
             return t.a == corner.said_by && t.b == b && t.gap <= height + 1e-9 && n.dot(t.normal) > 1 - 1e-12 &&
                    (t.point_a + thick * t.normal - center).squaredNorm() < 1e-18;
           });
  };
  planes_.clear();
  for (std::size_t r = first_row; r < rows_.size(); ++r) {
    const Vec3 &n = rows_[r].touch.normal, &p = rows_[r].touch.point_b;
    if (std::all_of(corners.begin(), corners.end(), [&](const Corner& c) { return keeps_off(c, n, p); }))
      planes_.push_back({n, n.dot(p)});
  }
}

// A touch as the sphere of its core point. Of a touch that stands for a patch of triangles that is the core point
// nearest to the patch's vertex: straight above the vertex one may be beside the shape, by up to 0.8 mm, and a sphere
// there would meet what the shape does not.
void Contacts::make_row(std::size_t left) {
  Touch& t = as_row_[left];
  const collision::Tree* tree = world_.mesh(t.b);
  if (std::exchange(made_[left], 1) || tree == nullptr) return;
  const Shape& shape = *world_.shape(t.a);
  const Pose<double>&at_a = world_.pose(t.a), &mesh = world_.pose(t.b);
  const Vec3 center = shape.core() == Core::hull ? Vec3(t.point_a + shape.radius() * t.normal)
                                                 : Vec3(at_a * shape.nearest(into(at_a, t.point_b)));
  if (foot_.a != t.a || foot_.b != t.b || foot_.center != center) {
    const auto found = nearest(*tree, into(mesh, center), (center - t.point_b).norm() + rounding);
    foot_ = {t.a, t.b, center, found && found->distance > 0, found ? Vec3(mesh * found->point) : Vec3::Zero()};
  }
  if (foot_.clear) t = touch_of(t.a, t.b, center, shape.radius(), foot_.point);
}

bool Contacts::is_said(const Touch& t) const {
  return std::ranges::any_of(rows_, [&](const Row& row) {
    return row.touch.a == t.a && row.touch.b == t.b &&
           (row.touch.point_a - t.point_a).squaredNorm() < rounding * rounding &&
           (row.touch.normal - t.normal).squaredNorm() < rounding * rounding;
  });
}

void Contacts::add_row(const Row& row) {
  if (!is_said(row.touch)) rows_.push_back(row);
}

// What the manifold has kept from number `from` on.
void Contacts::add_kept(std::size_t from, bool repeat) {
  for (const std::uint32_t i : manifold_.kept().subspan(from)) {
    make_row(i);
    if (repeat || !is_said(as_row_[i])) rows_.push_back({as_row_[i], key_of(as_row_[i], 1 << 10, left_[i].feature), 0});
  }
}

// Only touches that the motion violates are tried as rows. A row is about the nearest triangle, which may be another
// than its touch's, so that a row may be violated though its touch is not. Trying all of them gave the motion of all
// rows to 9e-9 m (else 0.2 mm in a few frames of a grasp), at twice the time of the slow frames.
int Contacts::complete(std::span<const Vec<double, 6>> motion, double gap, bool push) {
  std::copy(motion.begin(), motion.end(), motion_.begin());
  for (std::size_t i = 0; i < left_.size(); ++i) {
    const Touch& t = left_[i];
    const Vec<double, 6>& way = motion_[at(t.a)];
    const Vec3 path = way.head<3>() + way.tail<3>().cross(t.point_a - world_.pose(t.a).position);
    if (t.gap + t.normal.dot(path) >= gap) continue;
    make_row(i);
    if (is_said(as_row_[i])) manifold_.pass_over(static_cast<std::uint32_t>(i));
  }
  const std::size_t before = manifold_.kept().size();
  const int added = manifold_.complete(as_row_, world_, motion_, gap, completion_tolerance, push);
  add_kept(before, false);
  return added;
}

double Contacts::time_of_contact(std::span<const Vec<double, 6>> screws) {
  moves_.clear();
  for (std::size_t b = 0; b < screws.size(); ++b)
    if (!screws[b].isZero(0)) moves_.push_back({static_cast<int>(b), screws[b]});
  return world_.time_of_contact(moves_).time;
}

double Contacts::gap(double reach) {
  double least = reach;
  for (const Touch& t : world_.touches(reach)) least = std::min(least, t.gap);
  return least;
}

}  // namespace zwang::god
