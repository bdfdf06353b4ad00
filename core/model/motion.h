#pragma once

#include <span>

#include <zwang/core/model/assemble.h>
#include <zwang/core/model/scene.h>

namespace zwang {

// The unconstrained motion z_u [m/s^2; rad/s^2], 6 entries per free body in the order of the bodies, and the step that
// turns a constrained z into new poses.

// Quasi-static god objects (Eq. 2): z_u = k_s (x_target - x_god), position and rotation vector stacked. `target` has
// one pose per body; those of bodies that are not free are ignored. k_s [1/s^2]: 1/dt^2 reaches the target in one free
// step of length dt. Throws std::invalid_argument when the numbers of bodies differ.
void couple_to_targets(const Scene& scene, PoseSpan target, double k_s, Vector& z_u);
inline double reaching_stiffness(double dt) { return 1 / (dt * dt); }

// Dynamics (Newton-Euler): z_u = [g + f/m; I^-1 (tau - w x I w)]. `wrench` [N; N m] acts at the centres of mass in
// world axes, one per body, or none at all. Throws std::invalid_argument when the numbers of bodies differ.
void move_freely(const Scene& scene, const Vec3& gravity, std::span<const Vec<double, 6>> wrench, Vector& z_u);

// One step of length dt [s], stopped at the time of contact toc, a fraction of the swept path. The path is scaled ONCE:
//
//   quasi-static  x <- x (+) toc z dt^2                 velocities stay as they are (they count as zero)
//   dynamic       y <- y + z dt,  x <- x (+) toc y dt   symplectic Euler
//
// with (+) the exponential map for rotations. (Eq. 29-30 as printed multiply by toc twice; a body then creeps up to a
// wall, .5, .667, .75, ... of the way, and never touches it.) Bodies of prescribed motion take the same step with their
// own z; fixed bodies stay. `toc`: one for all bodies (the paper's global minimum) or one per body (per cluster, say).
// Throws std::invalid_argument when z is too short or toc has another length.
void integrate(Scene& scene, const Vector& z, double dt, Mode mode, std::span<const double> toc);
inline void integrate(Scene& scene, const Vector& z, double dt, Mode mode, double toc = 1) {
  integrate(scene, z, dt, mode, std::span(&toc, 1));
}

}  // namespace zwang
