#pragma once

#include <stdexcept>

#include <zwang/core/model/assemble.h>

namespace zwang {

// A scene and all that its problem is made of.
struct SceneStep {
  Scene scene = {};
  AssembleOptions options = {};
  // Of a quasi-static step (couple_to_targets): one a body, and 1/s^2.
  std::vector<Pose<double>> target = {};
  double k_s = 0;
  // Of a dynamic one (move_freely): m/s^2, and N, N m; one a body, or none.
  Vec3 gravity = Vec3::Zero();
  std::vector<Vec<double, 6>> wrench = {};
};

// A direction in which it changes: derivatives with respect to one parameter.
struct SceneChange {
  struct OfBody {
    Vec<double, 6> pose = Vec<double, 6>::Zero();      // a twist [m; rad], world axes: pose (+) parameter * twist
    Vec<double, 6> velocity = Vec<double, 6>::Zero();  // m/s; rad/s
    double mass = 0;                                   // kg; by density, so that the inertia grows in proportion
  };
  std::vector<OfBody> bodies = {};  // one a body
  double friction = 0;              // of every contact that has some
};

// What z_u is.
Vector unconstrained(const SceneStep& step);

// d M and d z_u, for a problem of this step whose numbers are derivatives already: M and z_u as assembled, soft
// unknowns last.
void change_masses(const SceneStep& step, const SceneChange& change, Problem& derivative);
void change_free_motion(const SceneStep& step, const SceneChange& change, Problem& derivative);

namespace moving {

// A number, and its derivative along the change.
using Number = Dual<1>;

inline Pose<Number> pose(const Pose<double>& q, const Vec<double, 6>& twist) {
  Pose<Number> out;
  const Mat3 turned = skew<double>(twist.tail<3>()) * q.rotation;
  for (int i = 0; i < 3; ++i) {
    out.position[i] = Number(q.position[i], Vec<double, 1>(twist[i]));
    for (int j = 0; j < 3; ++j) out.rotation(i, j) = Number(q.rotation(i, j), Vec<double, 1>(turned(i, j)));
  }
  return out;
}

// What a value and its Jacobian change by, along the change.
template <int rows, int columns>
struct Linear {
  Vec<double, rows> value;
  Mat<double, rows, columns> jacobian;
};

// By automatic derivatives of automatic derivatives. value(poses): `rows` numbers, for any scalar.
template <int rows, std::size_t bodies, class Value>
auto linear(const Value& value, const std::array<Pose<Number>, bodies>& q) {
  constexpr int N = 6 * static_cast<int>(bodies);
  const Vec<Dual<N, Number>, rows> v = value(seed_all(q));
  Linear<rows, N> out;
  for (int r = 0; r < rows; ++r) {
    out.value[r] = v[r].value().derivatives()[0];
    for (int k = 0; k < N; ++k) out.jacobian(r, k) = v[r].derivatives()[k].derivatives()[0];
  }
  return out;
}

// The derivatives of what ConstraintListOf<C>::write writes.
template <Constraint C>
void write(const ConstraintListOf<C>& list, const SceneStep& step, std::span<const RowPlace> places,
           const SceneChange& change, const RowFrame& frame) {
  constexpr std::size_t N = static_cast<std::size_t>(arity<C>);
  for (const RowPlace& place : places) {
    if (place.row == RowPlace::nowhere) continue;
    const C& constraint = list.all[place.item];
    PosesOf<C, double> still;
    std::array<Pose<Number>, N> q;
    for (std::size_t b = 0; b < N; ++b) {
      const auto body = static_cast<std::size_t>(constraint.bodies[b]);
      still[b] = step.scene.bodies[body].pose;
      q[b] = pose(still[b], change.bodies[body].pose);
    }
    const auto write_row = [&](Index i, const auto& jacobian, const auto& moved, int r, double c) {
      double* row = frame.J + frame.start[i];
      for (std::size_t b = 0; b < N; ++b) {
        const auto which = static_cast<std::size_t>(constraint.bodies[b]);
        const Body& body = step.scene.bodies[which];
        const auto twist = [&](const auto& J) -> Vec<double, 6> {
          return J.template block<1, 6>(r, 6 * static_cast<Index>(b)).transpose();
        };
        const Vec<double, 6> d = twist(moved);
        if (frame.moving) c -= (d.dot(body.velocity) + twist(jacobian).dot(change.bodies[which].velocity)) / frame.dt;
        if (body.motion == Motion::prescribed) c -= d.dot(body.prescribed);
        if (place.entry[b] >= 0) Eigen::Map<Vec<double, 6>>(row + place.entry[b]) = d;
      }
      frame.c[i] = c;
    };
    const Linearization<C> now = linearize(constraint, still);
    const auto moved = linear<C::rows>([&](const auto& at) { return evaluate(constraint, at); }, q);
    for (int r = 0; r < C::rows; ++r)
      write_row(place.row + r, now.jacobian, moved.jacobian, r, -moved.value[r] / (frame.dt * frame.dt));
    if constexpr (HasSlip<C>)
      if (constraint.friction != 0) {
        const auto offset = [&](const auto& at) {
          return std::apply([&](const auto&... each) { return constraint.offset(each...); }, at);
        };
        const Slip<arity<C>> slip = evaluate_slip(constraint, still, ArityIndices<C>{});
        const auto slid = linear<2>(offset, q);
        frame.mu[place.row] = change.friction;
        for (int r = 0; r < 2; ++r) write_row(place.row + 1 + r, slip.jacobian, slid.jacobian, r, 0);
      }
  }
}

}  // namespace moving

// The derivative of a scene's problem along a change of the scene: a Problem with the pattern of what Assembler makes
// of the step, whose M, z_u, J, c and mu are derivatives. Which rows there are does not change with it. `Kinds`: the
// types of all constraints that the scene has, each with value() for any scalar. Throws std::invalid_argument where the
// scene has another, and where the change is not one of its bodies.
template <Constraint... Kinds>
Problem changed(const SceneStep& step, const SceneChange& change) {
  const Scene& scene = step.scene;
  if (change.bodies.size() != scene.bodies.size())
    throw std::invalid_argument("scene '" + scene.name + "': a change of " + std::to_string(change.bodies.size()) +
                                " bodies, and there are " + std::to_string(scene.bodies.size()));
  Assembler assembler;
  Problem d;
  assembler.assemble(scene, unconstrained(step), step.options, d);
  change_masses(step, change, d);
  change_free_motion(step, change, d);
  d.J.coeffs().setZero();
  d.c.setZero();
  d.mu.setZero();
  const RowFrame frame{.start = d.J.outerIndexPtr(),
                       .J = d.J.valuePtr(),
                       .c = d.c.data(),
                       .mu = d.mu.data(),
                       .soft_mass = nullptr,
                       .dt = step.options.dt,
                       .moving = step.options.mode == Mode::dynamic};
  assembler.for_each_list(scene, [&](const ConstraintList& list, std::span<const RowPlace> places) {
    const auto is = [&]<class C>(const ConstraintListOf<C>* known) {
      if (known) moving::write(*known, step, places, change, frame);
      return known != nullptr;
    };
    if (!(is(dynamic_cast<const ConstraintListOf<Kinds>*>(&list)) || ...))
      throw std::invalid_argument("scene '" + scene.name + "': no derivative of the constraint '" +
                                  std::string(list.type()) + "' is known here");
  });
  return d;
}

}  // namespace zwang
