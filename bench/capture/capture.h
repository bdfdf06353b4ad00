#pragma once

#include <filesystem>
#include <functional>

#include <zwang/core/problem/instance.h>

namespace zwang {

struct CaptureOptions {
  std::filesystem::path model = {};  // MJCF or URDF
  int steps = 500;                   // of the model's own length
  int every = 1;                     // one problem in so many steps
  bool friction = false;             // contacts of the model with friction have tangent rows
};

// Steps a model with MuJoCo and hands over the problem of a step: MuJoCo's rows with the softness taken out,
//
//   minimize 1/2 (z - z_u)' M (z - z_u)   subject to   J z = c (equalities),  J z >= c (limits, contacts)
//
// in generalized coordinates [m/s^2 or rad/s^2], M = MuJoCo's inertia, z_u = qacc_smooth, J = efc_J, c = efc_aref.
// What MuJoCo itself answers, qacc, is recorded beside it. Contacts have one row and joints no friction (condim 1,
// frictionloss 0), in MuJoCo's run as well, so that both answer one problem. With `friction`, contacts that the model
// gives condim 3 or more have two tangent rows under Coulomb's law, c_t = -J_t qvel / dt, and mu, the first of the
// model's coefficients; the run is still MuJoCo's frictionless one, and no answer of its is recorded. Row keys last
// from step to step.
//
// `found`: called with each problem. Throws BadFile with MuJoCo's own message.
void capture(const CaptureOptions& options, const std::function<void(int step, const Instance&)>& found);

}  // namespace zwang
