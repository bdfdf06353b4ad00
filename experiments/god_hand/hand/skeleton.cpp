#include <zwang/experiments/god_hand/hand/skeleton.h>

#include <algorithm>
#include <stdexcept>

#include <zwang/bench/scenes/physical.h>

namespace zwang::god {
namespace {

// The smallest rotation that takes one unit vector to another, not opposed one.
Mat3 turn_between(const Vec3& from, const Vec3& to) {
  const Mat3 W = skew<double>(from.cross(to));
  return Mat3::Identity() + W + W * W / (1 + from.dot(to));
}

// One step of the Newton iteration for the polar factor: rounding of many products stays at rounding.
void make_orthonormal(Mat3& R) { R = R * (1.5 * Mat3::Identity() - 0.5 * R.transpose() * R); }

// What is left of the child's rotation within the joint.
Mat3 allowed(const BallJoint&, const Mat3&, const Mat3& child) { return child; }
Mat3 allowed(const Weld& j, const Mat3& parent, const Mat3&) { return parent * j.relative; }
Mat3 allowed(const RevoluteJoint& j, const Mat3& parent, const Mat3& child) {
  return turn_between(child * j.axis_b, parent * j.axis_a) * child;
}
Mat3 allowed(const UniversalJoint& j, const Mat3& parent, const Mat3& child) {
  const Vec3 a = parent * j.axis_a, b = child * j.axis_b;
  return turn_between(b, (b - a.dot(b) * a).normalized()) * child;
}

// Turns the child back to a bound that it is beyond, about the axis that the limit counts about: the parent's, or its
// own where the limit looks from the child.
void hold(const JointLimit& limit, BodyId child, std::span<Pose<double>> poses) {
  const auto [a, b] = limit.bodies;
  const Pose<double>&of_a = poses[at(a)], &of_b = poses[at(b)];
  const double beyond = limit.beyond(of_a, of_b);
  if (beyond == 0) return;
  const double back = (b == child ? 1 : -1) * static_cast<int>(limit.side) * beyond;
  Mat3& R = poses[at(child)].rotation;
  R = rotation(back * of_a.turn(limit.axis)) * R;
}

}  // namespace

Skeleton::Skeleton(Scene scene) : bodies_(scene.bodies.size()) {
  std::vector<Link> links;
  each_joint_list(scene, [&](const auto& list) {
    for (const auto& joint : list.all) links.push_back({joint, joint.bodies});
  });
  for (const JointLimit& limit : scene.list_of<JointLimit>().all)
    for (Link& link : links)
      if (link.bodies == limit.bodies || (link.bodies[0] == limit.bodies[1] && link.bodies[1] == limit.bodies[0]))
        link.limits.push_back(limit);

  std::vector<char> waits(bodies_, 0);
  for (const Link& link : links)
    if (waits[at(link.bodies[1])]++)
      throw std::invalid_argument("god object " + std::to_string(link.bodies[1]) + " hangs on two joints");
  while (!links.empty()) {
    const auto ready = std::find_if(links.begin(), links.end(), [&](const Link& l) { return !waits[at(l.bodies[0])]; });
    if (ready == links.end()) throw std::invalid_argument("the joints of the god objects close a loop");
    waits[at(ready->bodies[1])] = 0;
    links_.push_back(std::move(*ready));
    links.erase(ready);
  }
}

void Skeleton::close(std::span<Pose<double>> poses, bool limits) const {
  for (std::size_t b = 0; b < bodies_; ++b) make_orthonormal(poses[b].rotation);
  for (const Link& link : links_) {
    const Pose<double>& parent = poses[at(link.bodies[0])];
    Pose<double>& child = poses[at(link.bodies[1])];
    std::visit(
        [&](const auto& joint) {
          child.rotation = allowed(joint, parent.rotation, child.rotation);
          for (const JointLimit& limit : link.limits)
            if (limits) hold(limit, link.bodies[1], poses);
          child.position = parent * joint.anchor_a - child.turn(joint.anchor_b);
        },
        link.joint);
  }
}

double Skeleton::separation(PoseSpan poses) const {
  double most = 0;
  for (const Link& link : links_)
    std::visit(
        [&](const auto& joint) {
          const Pose<double>&a = poses[at(link.bodies[0])], &b = poses[at(link.bodies[1])];
          most = std::max(most, (a * joint.anchor_a - b * joint.anchor_b).norm());
        },
        link.joint);
  return most;
}

double Skeleton::excess(PoseSpan poses) const {
  double most = 0;
  for (const Link& link : links_)
    for (const JointLimit& limit : link.limits)
      most = std::max(most, limit.beyond(poses[at(limit.bodies[0])], poses[at(limit.bodies[1])]));
  return most;
}

}  // namespace zwang::god
