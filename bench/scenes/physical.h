#pragma once

#include <span>

#include <zwang/bench/scenes/catalog.h>
#include <zwang/bench/scenes/draw.h>
#include <zwang/core/model/scene_change.h>

namespace zwang {

inline constexpr double scene_dt = 0x1p-10;  // s: the step of mechanisms and boxes

// Physical scenes are built in dyadic numbers where that is cheap, so that the stored doubles are the problem.
inline const Vec3 gravity{0, 0, -9.8125};  // m/s^2

// A rotation by a vector [rad].
inline Mat3 rotation(const Vec3& w) {
  return retract(Pose<double>{}, (Vec<double, 6>() << Vec3::Zero(), w).finished()).rotation;
}

// A solid box (full widths, m) of a mass [kg].
Body box_body(const Vec3& widths, double mass, const Vec3& position);
BodyId add_fixed(Scene& scene, const Vec3& position = Vec3::Zero());

// Contacts of A with the face of B at these points, touching: "LABEL, corner 1" and so on.
void add_corners(Scene& scene, BodyId a, BodyId b, std::span<const Vec3> corners, const Vec3& normal,
                 const std::string& label);

// The scene's problem, its rows named.
Instance to_instance(Scene& scene, const Vector& z_u, const AssembleOptions& options);
// The same with z_u made of the step, which the instance keeps.
Instance to_instance(SceneStep step);

// What gravity and these wrenches make of a scene whose contacts rub with the knob `mu`.
Instance let_go(Scene& scene, const Knobs& knobs, std::span<const Vec<double, 6>> wrench = {});

// hands.cpp: `hands` of them (default 1), independent of each other.
SceneStep pose_hands(const Knobs& knobs);
SceneStep drifting_hand(double contacts);  // one, over whose frames rows come and go

}  // namespace zwang
