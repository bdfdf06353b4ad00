#include <zwang/experiments/god_hand/motion/retarget.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace zwang::god {
namespace {

using hand::Model;
constexpr int unknowns = 6 + hand::angles, rows = 60;  // palm's twist, angles; 5 fingers' 4 joints
using Unknowns = Vec<double, unknowns>;
using Residual = Vec<double, rows>;
using Jacobian = Mat<double, rows, unknowns>;

Vec3 tip_of(const hand::Phalanx& bone) { return {0, bone.length / 2, 0}; }

// Modelled minus recorded joints, and, if asked for, their derivative: a turn about an axis through a joint moves what
// lies beyond it.
Residual residual(const Model& model, const Target& at, const RecordedHand& to, Jacobian* J = nullptr) {
  const hand::Poses poses = hand::forward_kinematics(at.palm, at.angles, model);
  Residual r;
  if (J != nullptr) J->setZero();
  for (std::size_t f = 0; f < 5; ++f) {
    const hand::Finger& finger = model.fingers[f];
    std::array<Vec3, 4> p{at.palm * finger.base};
    for (std::size_t k = 0; k < 3; ++k) p[k + 1] = poses[1 + 3 * f + k] * tip_of(finger.bone[k]);
    for (std::size_t k = 0; k < 4; ++k) r.segment<3>(static_cast<Index>(12 * f + 3 * k)) = p[k] - to.joints[f][k];
    if (J == nullptr) continue;

    const Mat3& first = poses[1 + 3 * f].rotation;
    const double side = model.left ? -1 : 1, b = side * at.angles[4 * f + 1];
    const Vec3 sideways = side * first.col(2), flexion = -(first * Vec3(std::cos(b), -std::sin(b), 0));
    const std::array<Vec3, 4> axis{flexion, sideways, -first.col(0), -first.col(0)};
    const std::array<std::size_t, 4> joint{0, 0, 1, 2};
    for (std::size_t k = 0; k < 4; ++k) {
      const auto row = static_cast<Index>(12 * f + 3 * k);
      J->block<3, 3>(row, 0).setIdentity();
      J->block<3, 3>(row, 3) = -skew<double>(p[k] - at.palm.position);
      for (std::size_t a = 0; a < 4; ++a)
        if (joint[a] < k) J->block<3, 1>(row, static_cast<Index>(6 + 4 * f + a)) = axis[a].cross(p[k] - p[joint[a]]);
    }
  }
  return r;
}

Target moved(const Model& model, Target at, const Unknowns& step) {
  at.palm = retract(at.palm, Vec<double, 6>(step.head<6>()));
  for (int a = 0; a < hand::angles; ++a) {
    const hand::Range limit = model.range(a);
    double& angle = at.angles[static_cast<std::size_t>(a)];
    angle = std::clamp(angle + step[6 + a], limit.low, limit.high);
  }
  return at;
}

// Least squares over the palm's pose and the angles within their limits: Levenberg-Marquardt on the variables that no
// limit holds (an angle at a limit that the gradient pushes against is out of the step), steps cut at the limits.
// Clamping an unbounded fit instead leaves the wrist and the neighbouring joints where they served an angle that is not
// there: twice the misfit. `free_palm` false: the palm stays.
Target fitted(const Model& model, Target at, const RecordedHand& to, bool free_palm = true) {
  double damping = 1e-6;
  Jacobian J;
  Residual r = residual(model, at, to, &J);
  for (int iteration = 0; iteration < 60; ++iteration) {
    const Unknowns g = J.transpose() * r;
    Mat<double, unknowns, unknowns> H = J.transpose() * J;
    Unknowns gradient = g;
    const auto hold = [&](int k) {
      H.row(k).setZero();
      H.col(k).setZero();
      H(k, k) = 1;
      gradient[k] = 0;
    };
    for (int k = 0; k < 6 && !free_palm; ++k) hold(k);
    for (int a = 0; a < hand::angles; ++a) {
      const hand::Range limit = model.range(a);
      const double angle = at.angles[static_cast<std::size_t>(a)];
      if ((angle <= limit.low && g[6 + a] > 0) || (angle >= limit.high && g[6 + a] < 0)) hold(6 + a);
    }
    double size = 0;
    for (bool better = false; !better && damping < 1e6; damping *= better ? 0.2 : 5) {
      Mat<double, unknowns, unknowns> D = H;
      D.diagonal() += damping * H.diagonal() + Unknowns::Constant(1e-12);
      const Target next = moved(model, at, -Unknowns(Matrix(D).ldlt().solve(gradient)));
      const Residual there = residual(model, next, to);
      better = there.squaredNorm() < r.squaredNorm();
      if (!better) continue;
      size = r.squaredNorm() - there.squaredNorm();
      at = next;
    }
    damping = std::max(damping, 1e-9);
    if (size <= 1e-9 * r.squaredNorm() + 1e-14) break;
    r = residual(model, at, to, &J);
  }
  return at;
}

// Where the model's palm is in a recorded hand: the frames have the same axes, their origins differ by a constant [m].
Target start_of(const RecordedHand& h, const Vec3& offset) { return {.palm = {h.palm * offset, h.palm.rotation}}; }

std::vector<const RecordedHand*> sample(const RecordedTrack& track, std::size_t most) {
  std::vector<const RecordedHand*> all;
  for (const RecordedTrack::Sample& f : track.frames)
    if (f.hand) all.push_back(&*f.hand);
  if (all.empty()) throw std::invalid_argument("a track without a hand in it");
  std::vector<const RecordedHand*> some;
  const std::size_t count = std::min(most, all.size());
  for (std::size_t k = 0; k < count; ++k) some.push_back(all[k * all.size() / count]);
  return some;
}

// What a radian counts as [m]: of a bone that is not along the face, of one that is on its side, away from `near`.
constexpr double along_face = 0.1, on_side = 3e-3, from_near = 1e-3;
constexpr double far_off = 2e-3;  // m

Vector residual(const hand::Model& model, const Target& at, const Target& near, std::span<const Pad> pads) {
  const hand::Poses poses = hand::forward_kinematics(at.palm, at.angles, model);
  Vector r(7 * static_cast<Index>(pads.size()) + unknowns);
  Index k = 0;
  for (const Pad& pad : pads) {
    const Pose<double>& pose = poses[static_cast<std::size_t>(pad.body)];
    r.segment<3>(k) = pose.position + model.phalanx(pad.body).radius * pad.into - pad.point;
    r.segment<3>(k + 3) = on_side * (-pose.rotation.col(2) - pad.into);
    r[k + 6] = along_face * pose.rotation.col(1).dot(pad.into);
    k += 7;
  }
  r.segment<6>(k) = from_near * twist_between(near.palm, at.palm);
  for (std::size_t a = 0; a < hand::angles; ++a)
    r[k + 6 + static_cast<Index>(a)] = from_near * (at.angles[a] - near.angles[a]);
  return r;
}

// Gauss-Newton over each finger's base, spread and roll (5 numbers), the angles of the sampled frames eliminated: at
// the angles fitted to the present measures only what they cannot follow counts (variable projection, Kaufman's form).
// Little pulls toward the start, so that what the recording does not show (the roll of a finger that never bends) stays
// the standard hand's.
Model fit_model(const RecordedTrack& track) {
  const std::vector<const RecordedHand*> hands = sample(track, 60);
  const auto count = static_cast<double>(hands.size());
  Model model = track.left ? hand::mirrored(hand::standard()) : hand::standard();
  std::array<Vec3, 5> bases;
  bases.fill(Vec3::Zero());
  double length = 0, usual = 0;
  for (std::size_t f = 0; f < 5; ++f) {
    for (const RecordedHand* h : hands)
      bases[f] += h->palm.rotation.transpose() * (h->joints[f][0] - h->palm.position) / count;
    for (std::size_t k = 0; k < 3; ++k) {
      double sum = 0;
      for (const RecordedHand* h : hands) sum += h->bone(f, k);
      usual += model.fingers[f].bone[k].length;
      model.fingers[f].bone[k].length = sum / count;
      length += sum / count;
    }
  }
  const double s = length / usual;
  model.palm_widths *= s;
  model.palm_mass *= s * s * s;
  Vec3 offset = Vec3::Zero();
  for (std::size_t f = 1; f < 5; ++f) offset += (bases[f] - s * model.fingers[f].base) / 4;
  for (std::size_t f = 0; f < 5; ++f) {
    model.fingers[f].base = bases[f] - offset;
    for (hand::Phalanx& bone : model.fingers[f].bone) {
      bone.mass *= s * s * s;
      bone.radius *= s;
    }
  }

  using Measures = Vec<double, 5>;  // base [m], spread, roll [rad]
  const auto changed = [](Model m, std::size_t f, const Measures& by) {
    m.fingers[f].base += by.head<3>();
    m.fingers[f].spread += by[3];
    m.fingers[f].roll += by[4];
    return m;
  };
  const Measures pull = count * Measures(0.1, 0.1, 0.1, 1e-5, 1e-5);  // a radian counts as 3 mm
  std::array<Measures, 5> away;
  away.fill(Measures::Zero());
  std::vector<Target> at = mapped(hands, [&](const RecordedHand* h) { return start_of(*h, offset); });
  for (int iteration = 0; iteration < 12; ++iteration) {
    std::array<Mat<double, 5, 5>, 5> N;
    std::array<Measures, 5> g;
    for (std::size_t f = 0; f < 5; ++f) {
      N[f] = pull.asDiagonal();
      g[f] = pull.cwiseProduct(away[f]);
    }
    for (std::size_t i = 0; i < hands.size(); ++i) {
      at[i] = fitted(model, at[i], *hands[i], false);
      Jacobian J;
      const Residual r = residual(model, at[i], *hands[i], &J);
      Mat<double, rows, 5> B;
      for (int k = 0; k < 5; ++k) {
        constexpr double h = 1e-6;
        Model m = model;
        for (std::size_t f = 0; f < 5; ++f) m = changed(m, f, h * Measures::Unit(k));
        B.col(k) = (residual(m, at[i], *hands[i]) - r) / h;
      }
      for (std::size_t f = 0; f < 5; ++f) {
        const auto row = static_cast<Index>(12 * f);
        Mat<double, 12, 4> A = J.block<12, 4>(row, static_cast<Index>(6 + 4 * f));
        for (std::size_t a = 0; a < 4; ++a) {
          const hand::Range limit = model.fingers[f].range[a];
          const double angle = at[i].angles[4 * f + a];
          if (angle <= limit.low || angle >= limit.high) A.col(static_cast<Index>(a)).setZero();
        }
        Mat<double, 12, 5> P = B.middleRows<12>(row);
        Mat<double, 4, 4> AA = A.transpose() * A;
        AA.diagonal().array() += 1e-12;
        P -= A * Matrix(AA).ldlt().solve(A.transpose() * P);
        N[f] += P.transpose() * P;
        g[f] += P.transpose() * r.segment<12>(row);
      }
    }
    double most = 0;
    for (std::size_t f = 0; f < 5; ++f) {
      Measures step = -Measures(Matrix(N[f]).ldlt().solve(g[f]));
      step *= std::min(1.0, 0.2 / step.tail<2>().lpNorm<Eigen::Infinity>());
      model = changed(model, f, step);
      away[f] += step;
      most = std::max(most, step.lpNorm<Eigen::Infinity>());
    }
    if (most < 1e-4) break;
  }
  return model;
}

}  // namespace

Track retarget(const RecordedTrack& track) {
  const Model model = fit_model(track);
  Track out{.model = model, .beyond = track.beyond};
  Vec3 offset = Vec3::Zero();
  const std::vector<const RecordedHand*> hands = sample(track, 60);
  for (const RecordedHand* h : hands)
    for (std::size_t f = 0; f < 5; ++f)
      offset += (h->palm.rotation.transpose() * (h->joints[f][0] - h->palm.position) - model.fingers[f].base) /
                (5 * static_cast<double>(hands.size()));
  std::size_t fits = 0;
  for (const RecordedTrack::Sample& frame : track.frames) {
    if (!frame.hand) {
      append(out, {frame.time, {.tracked = false}});
      continue;
    }
    Target from = start_of(*frame.hand, offset);
    if (!out.keys.empty()) from.angles = out.keys.back().target.angles;
    const Target at = fitted(model, from, *frame.hand);
    const std::size_t held = out.held_over;
    append(out, {frame.time, at});
    if (out.held_over > held) continue;
    const Residual r = residual(model, at, *frame.hand);
    for (Index k = 0; k < rows; k += 3) {
      out.misfit_mean += r.segment<3>(k).norm();
      out.misfit_most = std::max(out.misfit_most, r.segment<3>(k).norm());
    }
    ++fits;
  }
  if (fits > 0) out.misfit_mean /= 20 * static_cast<double>(fits);
  return out;
}

Target with_pads(const hand::Model& model, const Target& near, std::span<const Pad> pads) {
  constexpr double probe = 1e-6;
  Target at = near;
  double damping = 1e-3;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Vector r = residual(model, at, near, pads);
    Matrix J(r.size(), unknowns);
    for (int k = 0; k < unknowns; ++k) {
      Unknowns by = Unknowns::Zero();
      by[k] = probe;
      const Vector ahead = residual(model, moved(model, at, by), near, pads);
      by[k] = -probe;
      const Vector behind = residual(model, moved(model, at, by), near, pads);
      J.col(k) = (ahead - behind) / (2 * probe);
    }
    Matrix H = J.transpose() * J;
    H.diagonal().array() += damping * 1e-4;
    const Target next = moved(model, at, -Unknowns(H.ldlt().solve(J.transpose() * r)));
    if (residual(model, next, near, pads).squaredNorm() < r.squaredNorm()) {
      at = next;
      damping = std::max(damping / 4, 1e-9);
    } else {
      damping *= 5;
      if (damping > 1e8) break;
    }
  }
  const Vector r = residual(model, at, near, pads);
  for (std::size_t k = 0; k < pads.size(); ++k)
    if (r.segment<3>(7 * static_cast<Index>(k)).norm() > far_off)
      throw std::invalid_argument("the hand does not reach around it: " + hand::body_name(pads[k].body) + " is " +
                                  std::to_string(1e3 * r.segment<3>(7 * static_cast<Index>(k)).norm()) + " mm off");
  return at;
}

}  // namespace zwang::god
