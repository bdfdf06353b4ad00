#pragma once

#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <zwang/constraints/ball_joint.h>
#include <zwang/constraints/contact.h>
#include <zwang/constraints/distance.h>
#include <zwang/constraints/friction_pyramid.h>
#include <zwang/constraints/joint_limit.h>
#include <zwang/constraints/prismatic_joint.h>
#include <zwang/constraints/revolute_joint.h>
#include <zwang/constraints/rope.h>
#include <zwang/constraints/target_coupling.h>
#include <zwang/constraints/universal_joint.h>
#include <zwang/constraints/weld.h>

namespace zwang {

// The unit of each row's acceleration J z - c, read off its derivative: a row that shifting a body changes is a length,
// one that only turning changes is an angle (or a sine).
template <Constraint C>
std::vector<std::string_view> row_units(const C& c = {}) {
  PosesOf<C, double> q;
  for (std::size_t b = 0; b < q.size(); ++b) {
    Vec<double, 6> somewhere;
    somewhere << 0.3, -0.7, 1.1, 0.2, 0.5, -0.4;
    q[b] = retract(Pose<double>{}, Vec<double, 6>((1 + static_cast<double>(b)) * somewhere));
  }
  const auto J = linearize(c, q).jacobian;
  std::vector<std::string_view> units(C::rows, "rad/s^2");
  for (int r = 0; r < C::rows; ++r)
    for (int b = 0; b < arity<C>; ++b)
      if (!J.template block<1, 3>(r, 6 * b).isZero()) units[static_cast<std::size_t>(r)] = "m/s^2";
  return units;
}

// Of a row by its name, "type/label [row]"; "" where no constraint here has that type.
inline std::string_view row_unit(const std::string& origin) {
  static const auto units = [] {
    std::map<std::string, std::vector<std::string_view>, std::less<>> all;
    const auto add = [&all]<class... C>() { ((all[std::string(C::name)] = row_units<C>()), ...); };
    add.template operator()<BallJoint, Contact, Distance, FrictionPyramid, JointLimit, PrismaticJoint, RevoluteJoint,
                            Rope, TargetCoupling, UniversalJoint, Weld>();
    return all;
  }();
  const auto found = units.find(origin.substr(0, origin.find('/')));
  if (found == units.end()) return "";
  const auto place = origin.rfind(" [");
  const bool several = place != std::string::npos && origin.back() == ']';
  const std::size_t row = several ? std::strtoul(origin.c_str() + place + 2, nullptr, 10) : 0;
  return row < found->second.size() ? found->second[row] : "";
}

}  // namespace zwang
