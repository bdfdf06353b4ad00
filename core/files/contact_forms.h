#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <zwang/core/problem/instance.h>

// Contact problems as FCLIB and Siconos write them: a contact has `dim` columns [N, T1, T2, rolling...], its velocities
// are u, its forces r. mu has one number a contact, or none where nothing is known of friction.
namespace zwang {

// Throws: the place and what is wrong there.
using Fail = std::function<void(const std::string& place, const std::string& what)>;

// M v = H r + G lambda + f, G'v + b = 0, u = H'v + w. The first `sliding` of T are directions of slip.
struct GlobalForm {
  Index dim = 3, sliding = 2;
  SparseMatrix M = {}, H = {}, G = {};  // n x n, n x dim * contacts, n x e
  Vector f = {}, w = {}, b = {}, mu = {};
  bool f_is_motion = false;  // f holds M^-1 f, exactly
};
Instance from_global_form(GlobalForm form, const Fail& fail);

// u = W r + V lambda + q, V'r + R lambda + s = 0; V, R and s may be empty. The Delassus form only: with M = I and
// z_u = 0, any J with J J' = [R V'; V W] gives the same problem up to a rotation of z. Only the rows in use are
// factored: all, or the normal ones of a problem without friction.
struct LocalForm {
  Index dim = 3;
  SparseMatrix W = {}, V = {}, R = {};
  Vector q = {}, mu = {}, s = {};
};
Instance from_local_form(LocalForm form, std::optional<Law> law, const Fail& fail);

// M with both triangles: one that is empty is mirrored, never averaged; rounding is settled by the lower one; a note
// says so. Fails where M is not symmetric.
void complete_symmetric(SparseMatrix& M, std::vector<std::string>& notes, const Fail& fail);

}  // namespace zwang
