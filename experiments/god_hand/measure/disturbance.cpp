#include <zwang/experiments/god_hand/measure/disturbance.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace zwang::god {
namespace {

using Vec7 = Vec<double, 7>;

// maximize r,  sum of a_g (wrench of g, 1) + r (direction, 0) + slack e_7 = (-weight, most),  a, r, slack >= 0
//
// by the simplex method: g are all rays of all cones, of which one with the largest reduced cost enters. Torques are in
// units of the longest lever. What is left of the first basis, seven unit columns, costs so much that it leaves.
class Program {
 public:
  Program(std::span<const Holding> contacts, const Vec3& weight, double mu) : contacts_(contacts), mu_(mu) {
    for (const Holding& c : contacts) {
      lever_ = std::max(lever_, c.point.norm());
      most_ += c.push;
    }
    right_ << -weight, Vec3::Zero(), most_;
  }

  double solve(const Vec3& direction) const {
    constexpr int most_pivots = 2000;
    constexpr double cost_of_missing = 1e6;
    Eigen::Matrix<double, 7, 7> basis = Eigen::Matrix<double, 7, 7>::Identity();
    Vec7 cost = Vec7::Constant(-cost_of_missing);
    cost[6] = 0;  // that one is the slack
    for (int i = 0; i < 7; ++i) basis(i, i) = right_[i] < 0 ? -1 : 1;
    Vec7 push;
    push << direction, 0, 0, 0, 0;
    Vec7 x = right_.cwiseAbs();
    for (int pivot = 0; pivot < most_pivots; ++pivot) {
      const Eigen::PartialPivLU<Eigen::Matrix<double, 7, 7>> factor(basis);
      x = factor.solve(right_);
      const Vec7 price = factor.transpose().solve(cost);
      Vec7 enters = push;
      double gain = 1 - price.dot(push), own = 1;
      for (const Holding& c : contacts_) {
        const Vec7 ray = ray_of(c, price);
        if (const double g = -price.dot(ray); g > gain) gain = g, enters = ray, own = 0;
      }
      if (-price[6] > gain) gain = -price[6], enters = Vec7::Unit(6), own = 0;
      if (gain <= 1e-11 * (1 + price.cwiseAbs().maxCoeff() * 1e-6)) break;
      const Vec7 way = factor.solve(enters);
      int leaves = -1;
      double least = std::numeric_limits<double>::infinity();
      for (int i = 0; i < 7; ++i)
        if (way[i] > 1e-12 && std::max(0.0, x[i]) / way[i] < least) least = std::max(0.0, x[i]) / way[i], leaves = i;
      if (leaves < 0) break;
      basis.col(leaves) = enters;
      cost[leaves] = own;
    }
    double missing = 0, found = 0;
    for (int i = 0; i < 7; ++i) (cost[i] < 0 ? missing : found) += cost[i] == 0 ? 0 : std::abs(x[i]);
    return missing > 1e-9 * most_ ? 0 : found;
  }

 private:
  // Of the contact's cone, with a normal part of 1, the one that is worth most.
  Vec7 ray_of(const Holding& c, const Vec7& price) const {
    const Vec3 worth = -(price.head<3>() + Vec3(price.segment<3>(3)).cross(c.point) / lever_);
    const Vec3 across = worth - c.along.dot(worth) * c.along;
    const double size = across.norm();
    const Vec3 force = c.along + (size > 0 ? Vec3(mu_ / size * across) : Vec3::Zero());
    return (Vec7() << force, c.point.cross(force) / lever_, 1).finished();
  }

  std::span<const Holding> contacts_;
  double mu_, lever_ = 1e-6, most_ = 0;  // m; N
  Vec7 right_;
};

}  // namespace

double largest_disturbance(std::span<const Holding> contacts, const Vec3& weight, double mu) {
  if (contacts.empty()) return 0;
  const Program program(contacts, weight, mu);
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 27; ++k) {
    const Vec3 direction(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    if (!direction.isZero(0)) least = std::min(least, program.solve(direction.normalized()));
  }
  return least;
}

Held held_hardest(const Frame& frame, const Surroundings& surroundings) {
  std::vector<double> pressed(surroundings.objects.size(), 0);
  const auto presses = [&](const FrameContact& c) {
    return c.object >= 0 && c.push > 0 && surroundings.objects[at(c.object)].loose();
  };
  for (const FrameContact& c : frame.contacts)
    if (presses(c)) pressed[at(c.object)] += c.push;
  const auto hardest = std::ranges::max_element(pressed);
  Held held;
  if (hardest == pressed.end() || *hardest == 0) return held;
  const auto object = at(hardest - pressed.begin());
  std::size_t loose = 0;
  for (std::size_t o = 0; o < object; ++o) loose += surroundings.objects[o].loose();
  for (const FrameContact& c : frame.contacts)
    if (presses(c) && at(c.object) == object)
      held.contacts.push_back({c.point - frame.loose[loose].position, -c.normal, c.push});
  held.weight = surroundings.objects[object].mass * surroundings.gravity;
  return held;
}

}  // namespace zwang::god
