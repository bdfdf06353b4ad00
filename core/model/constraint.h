#pragma once

#include <array>
#include <concepts>
#include <string_view>
#include <tuple>
#include <utility>

#include <zwang/core/model/pose.h>

namespace zwang {

// How many bodies a constraint acts on: 1 or 2.
template <class C>
inline constexpr int arity = std::tuple_size_v<decltype(C::bodies)>;

template <class C, class T>
using PosesOf = std::array<Pose<T>, at(arity<C>)>;

template <class C, class T, std::size_t... I>
auto evaluate(const C& c, const std::array<Pose<T>, sizeof...(I)>& q, std::index_sequence<I...>)
    -> decltype(c.value(q[I]...)) {
  return c.value(q[I]...);
}
template <class C, class T, std::size_t N>
auto evaluate(const C& c, const std::array<Pose<T>, N>& q) -> decltype(evaluate(c, q, std::make_index_sequence<N>{})) {
  return evaluate(c, q, std::make_index_sequence<N>{});
}

template <class C, std::size_t... I>
auto evaluate_jacobian(const C& c, const std::array<Pose<double>, sizeof...(I)>& q, std::index_sequence<I...>)
    -> decltype(c.jacobian(q[I]...)) {
  return c.jacobian(q[I]...);
}
template <class C, std::size_t... I>
auto evaluate_active(const C& c, const std::array<Pose<double>, sizeof...(I)>& q, std::index_sequence<I...>)
    -> decltype(c.active(q[I]...)) {
  return c.active(q[I]...);
}
template <class C, std::size_t... I>
auto evaluate_slip(const C& c, const std::array<Pose<double>, sizeof...(I)>& q, std::index_sequence<I...>)
    -> decltype(c.slip(q[I]...)) {
  return c.slip(q[I]...);
}
template <class C>
using ArityIndices = std::make_index_sequence<at(arity<C>)>;

// A constraint is a copyable struct with a name, a number of rows, a kind, its bodies, and one templated function
// value(poses...) that must stay zero (equality) or non-negative (inequality). Unit of the value: m or rad.
// Derivatives come from value() by automatic differentiation unless the struct offers jacobian(poses...). Optional
// active(poses...) -> bool: rows are written only while it holds (limits). Optional compliance() -> Vec<double, rows>:
// row i is soft with compliance()[i] [row's unit of acceleration per N or N m]; 0 keeps it hard. Assembly gives every
// soft row one extra unknown of mass 1/compliance (docs/formulation.md).
template <class C>
concept ActsOnOneOrTwoBodies = requires {
  std::tuple_size<decltype(C::bodies)>::value;
} && std::tuple_size_v<decltype(C::bodies)> >= 1 && std::tuple_size_v<decltype(C::bodies)> <= 2;
template <class C>
concept Constraint = std::copyable<C> && ActsOnOneOrTwoBodies<C> && requires(const C c, const PosesOf<C, double>& q) {
  { C::name } -> std::convertible_to<std::string_view>;
  { C::rows } -> std::convertible_to<int>;
  { C::kind } -> std::convertible_to<RowKind>;
  { evaluate(c, q) } -> std::same_as<Vec<double, C::rows>>;
};

// How a contact may slip: along two orthogonal tangents, each as long as its inequality row.
template <int bodies>
struct Slip {
  Mat<double, 2, 6 * bodies> jacobian = {};         // d slip / d twist, as a constraint's jacobian
  Vec<double, 2> surface = Vec<double, 2>::Zero();  // m/s, at which the face itself runs along them (a belt)
};

// jacobian(poses...) is rows x 6*arity: d value / d twist, [linear; angular] per body, world axes.
template <class C>
concept HasJacobian = requires(const C c, const PosesOf<C, double>& q) {
  { evaluate_jacobian(c, q, ArityIndices<C>{}) } -> std::same_as<Mat<double, C::rows, 6 * arity<C>>>;
};

template <class C>
concept HasCompliance = requires(const C c) {
  { c.compliance() } -> std::same_as<Vec<double, C::rows>>;
};

template <class C>
concept HasActive = requires(const C c, const PosesOf<C, double>& q) {
  { evaluate_active(c, q, ArityIndices<C>{}) } -> std::same_as<bool>;
};

// Optional, of one inequality row: slip(poses...) -> Slip, and `friction`, Coulomb's coefficient. Where that is not 0,
// two tangent rows follow the inequality row. Derivatives of a scene (scene_change.h) ask for offset(poses...) too,
// templated as value(): what slip's jacobian is the derivative of.
template <class C>
concept HasSlip = C::rows == 1 && C::kind == RowKind::inequality && requires(const C c, const PosesOf<C, double>& q) {
  { c.friction } -> std::convertible_to<double>;
  { evaluate_slip(c, q, ArityIndices<C>{}) } -> std::same_as<Slip<arity<C>>>;
};

// Has C a member of that name, whatever its signature? Then `&Beside<C>::name` is ambiguous.
struct OptionalMembers {
  int jacobian, compliance, active, slip;
};
template <class C>
struct Beside : C, OptionalMembers {};
// An optional member that is a little off would be left out without a word.
template <class C>
constexpr bool require_optional_members() {
  static_assert(!std::is_final_v<C>, "a constraint should not be final: its optional members could not be looked at");
  static_assert(
      HasJacobian<C> || requires { &Beside<C>::jacobian; },
      "jacobian(poses...) should be const, and return Mat<double, rows, 6 * bodies>");
  static_assert(
      HasCompliance<C> || requires { &Beside<C>::compliance; },
      "compliance() should be const, and return Vec<double, rows>");
  static_assert(HasActive<C> || requires { &Beside<C>::active; }, "active(poses...) should be const, and return bool");
  static_assert(
      HasSlip<C> ||
          requires(const C c) {
            &Beside<C>::slip;
            requires !requires { c.friction; };
          },
      "slip(poses...) should be const, return Slip<bodies>, and stand beside a number `friction` of one "
      "inequality row");
  return true;
}

// value(q (+) step) = value + jacobian * step + O(step^2).
template <Constraint C>
struct Linearization {
  Vec<double, C::rows> value;
  Mat<double, C::rows, 6 * arity<C>> jacobian;
};

// The poses, each with its six components of all twists.
template <class S, std::size_t bodies>
auto seed_all(const std::array<Pose<S>, bodies>& q) {
  constexpr int N = 6 * static_cast<int>(bodies);
  std::array<Pose<Dual<N, S>>, bodies> seeded;
  for (std::size_t b = 0; b < bodies; ++b) seeded[b] = seed<N>(q[b], 6 * static_cast<int>(b));
  return seeded;
}

template <Constraint C>
Linearization<C> differentiate(const C& c, const PosesOf<C, double>& q) {
  constexpr int N = 6 * arity<C>;
  const Vec<Dual<N>, C::rows> v = evaluate(c, seed_all(q));
  Linearization<C> out;
  for (int r = 0; r < C::rows; ++r) {
    out.value[r] = v[r].value();
    if (v[r].derivatives().size() == N)
      out.jacobian.row(r) = v[r].derivatives().transpose();
    else
      out.jacobian.row(r).setZero();
  }
  return out;
}

template <Constraint C>
Linearization<C> linearize(const C& c, const PosesOf<C, double>& q) {
  if constexpr (HasJacobian<C>)
    return {evaluate(c, q), evaluate_jacobian(c, q, ArityIndices<C>{})};
  else
    return differentiate(c, q);
}

}  // namespace zwang
