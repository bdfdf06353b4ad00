// check: is the constraint right? check wrong: what is said of a derivative of one's own with a wrong sign.
#include <cstring>

#include <zwang/tests/constraints/conformance.h>

#include "on_wire.h"

struct WrongWire : OnWire {
  zwang::Mat<double, 2, 12> jacobian(const zwang::Pose<double>& a, const zwang::Pose<double>& b) const {
    zwang::Mat<double, 2, 12> J = zwang::differentiate(OnWire(*this), {a, b}).jacobian;
    J(1, 10) = -J(1, 10);
    return J;
  }
};

int main(int count, char** words) {
  const OnWire wire{.point = {0.3, -0.2, 0.5},
                    .start = {-0.4, 0.25, 0.1},
                    .across = zwang::Vec3(2, -1, 2) / 3,
                    .across_too = zwang::Vec3(2, 2, -1) / 3};
  const bool wrong = count > 1 && std::strcmp(words[1], "wrong") == 0;
  return (wrong ? zwang::conformance::check(WrongWire{wire}) : zwang::conformance::check(wire)) ? 0 : 1;
}
