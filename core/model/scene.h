#pragma once

#include <array>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <zwang/core/model/constraint.h>
#include <zwang/core/problem/mix_bits.h>

namespace zwang {

enum class Motion : unsigned char { free, prescribed, fixed };

// Only free bodies have columns in the problem.
struct Body {
  Pose<double> pose = {};
  double mass = 1;                  // kg
  Mat3 inertia = Mat3::Identity();  // kg m^2, about the centre of mass, in body axes
  Motion motion = Motion::free;
  Vec<double, 6> velocity = Vec<double, 6>::Zero();    // y = [m/s; rad/s], world axes; zero in the quasi-static mode
  Vec<double, 6> prescribed = Vec<double, 6>::Zero();  // z of a prescribed body [m/s^2; rad/s^2]
};

// First column of every body in the problem, -1 where it has none. Returns 6 x (free bodies).
inline int first_columns(const std::vector<Body>& bodies, std::vector<int>& column) {
  int next = 0;
  column.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const bool free = bodies[b].motion == Motion::free;
    column[b] = free ? next : -1;
    next += free ? 6 : 0;
  }
  return next;
}

// A constraint that has rows in this frame: J's pattern, and the keys and names of its rows, follow from these alone.
struct ActiveConstraint {
  std::uint64_t key;
  std::size_t item;          // of its list
  int list;                  // of its scene
  std::array<BodyId, 2> on;  // its bodies; -1 where it has one only
  RowKind kind;
  unsigned char rows;  // 1..6
  unsigned char soft;  // bit r: row r has a compliance
  unsigned char arity : 4;
  unsigned char tangents : 4;  // rows of slip behind the others
};

// Where the rows of an active constraint belong in the problem.
struct RowPlace {
  static constexpr Index nowhere = -1;
  std::size_t item = 0;
  Index row = nowhere;                  // its first one; nowhere: none of its bodies has columns
  std::array<int, 2> entry = {-1, -1};  // where the six entries of each body begin within a row, -1 without columns
  int soft = 0;                         // its first soft unknown, counted from the first of all
};

// The frame that rows are written into.
struct RowFrame {
  const int* start;   // of the rows of J, compressed
  double* J;          // its values
  double* c;          // m
  double* mu;         // m, where there are tangent rows
  double* soft_mass;  // of the soft unknowns: 1/compliance
  double dt;          // s
  bool moving;        // velocities count
};

// Constraints are held by type, one vector each: two virtual calls a type and frame, none a constraint.
class ConstraintList {
 public:
  virtual ~ConstraintList() = default;
  virtual std::unique_ptr<ConstraintList> clone() const = 0;
  virtual std::string_view type() const = 0;
  virtual std::size_t size() const = 0;
  virtual const std::string& label(std::size_t i) const = 0;
  // Appends the constraints that are active at the bodies' poses, in order.
  virtual void activate(const std::vector<Body>& bodies, int list, std::vector<ActiveConstraint>& active) const = 0;
  // Linearizes the constraints of `places` at the bodies' poses, straight into their rows of J and c (assemble.h).
  virtual void write(const std::vector<Body>& bodies, std::span<const RowPlace> places,
                     const RowFrame& frame) const = 0;
};

template <Constraint C>
class ConstraintListOf final : public ConstraintList {
 public:
  std::unique_ptr<ConstraintList> clone() const override { return std::make_unique<ConstraintListOf>(*this); }
  std::string_view type() const override { return C::name; }
  std::size_t size() const override { return all.size(); }
  const std::string& label(std::size_t i) const override { return labels[i]; }

  void activate(const std::vector<Body>& bodies, int list, std::vector<ActiveConstraint>& active) const override {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if constexpr (HasActive<C>)
        if (!with_poses(all[i], bodies, [&](const auto&... pose) { return all[i].active(pose...); })) continue;
      unsigned soft = 0;
      if constexpr (HasCompliance<C>)
        for (int r = 0; r < C::rows; ++r) soft |= (all[i].compliance()[r] > 0 ? 1u : 0u) << r;
      active.push_back({keys[i],
                        i,
                        list,
                        {all[i].bodies.front(), arity<C> == 2 ? all[i].bodies.back() : -1},
                        C::kind,
                        C::rows,
                        static_cast<unsigned char>(soft),
                        arity<C>,
                        tangents(all[i])});
    }
  }

  void write(const std::vector<Body>& bodies, std::span<const RowPlace> places, const RowFrame& frame) const override {
    for (const RowPlace& place : places) {
      if (place.row == RowPlace::nowhere) continue;
      const C& constraint = all[place.item];
      const Linearization<C> linear = with_poses(constraint, bodies, [&](const auto&... pose) -> Linearization<C> {
        if constexpr (HasJacobian<C>)
          return {constraint.value(pose...), constraint.jacobian(pose...)};
        else
          return differentiate(constraint, {pose...});
      });
      [[maybe_unused]] double* soft_mass = frame.soft_mass + place.soft;
      const auto write_row = [&](Index i, const auto& jacobian, int r, double c) {
        double* row = frame.J + frame.start[i];
        for (std::size_t b = 0; b < arity<C>; ++b) {
          const Body& body = bodies[at(constraint.bodies[b])];
          const Vec<double, 6> twist = jacobian.template block<1, 6>(r, 6 * static_cast<Index>(b)).transpose();
          if (frame.moving) c -= twist.dot(body.velocity) / frame.dt;
          if (body.motion == Motion::prescribed) c -= twist.dot(body.prescribed);
          if (place.entry[b] >= 0) Eigen::Map<Vec<double, 6>>(row + place.entry[b]) = twist;
        }
        frame.c[i] = c;
      };
      for (int r = 0; r < C::rows; ++r) {
        write_row(place.row + r, linear.jacobian, r, 0 - linear.value[r] / (frame.dt * frame.dt));  // 0 - 0 is +0
        if constexpr (HasCompliance<C>)
          if (const double compliance = constraint.compliance()[r]; compliance > 0) {
            *soft_mass++ = 1 / compliance;
            frame.J[frame.start[place.row + r + 1] - 1] = 1;
          }
      }
      if constexpr (HasSlip<C>)
        if (tangents(constraint) > 0) {
          const Slip<arity<C>> slip =
              with_poses(constraint, bodies, [&](const auto&... pose) { return constraint.slip(pose...); });
          frame.mu[place.row] = constraint.friction;
          for (int r = 0; r < 2; ++r) write_row(place.row + 1 + r, slip.jacobian, r, slip.surface[r] / frame.dt);
        }
    }
  }

  std::vector<C> all = {};
  std::vector<std::string> labels = {};
  std::vector<std::uint64_t> keys = {};

 private:
  // A bad coefficient has rows too, so that it is seen.
  static unsigned char tangents([[maybe_unused]] const C& constraint) {
    if constexpr (HasSlip<C>)
      return constraint.friction != 0 ? 2 : 0;
    else
      return 0;
  }

  // Poses by reference: copying two into an array takes as long as a contact's row.
  template <class Visit>
  static auto with_poses(const C& constraint, const std::vector<Body>& bodies, const Visit& visit) {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return visit(bodies[at(constraint.bodies[I])].pose...);
    }(ArityIndices<C>{});
  }
};

// Bodies and the constraints among them.
class Scene {
 public:
  std::string name = {};
  std::vector<Body> bodies = {};

  Scene() = default;
  Scene(const Scene& other) : name(other.name), bodies(other.bodies) {
    for (const auto& list : other.lists_) lists_.push_back(list->clone());
  }
  Scene(Scene&&) = default;
  Scene& operator=(Scene other) {
    std::swap(name, other.name);
    std::swap(bodies, other.bodies);
    std::swap(lists_, other.lists_);
    return *this;
  }

  BodyId add(Body body) {
    bodies.push_back(std::move(body));
    return static_cast<BodyId>(bodies.size()) - 1;
  }

  // `label` names the constraint to people; `key` names its rows over frames (0: one is made from type and label).
  // Throws std::invalid_argument when it names a body that is not there, or one body twice.
  template <Constraint C>
  void add(C constraint, std::string label = {}, std::uint64_t key = 0) {
    static_assert(require_optional_members<C>());
    require_bodies(C::name, constraint.bodies.data(), arity<C>);
    auto& list = list_of<C>();
    if (label.empty()) label = std::to_string(list.all.size());
    if (key == 0) key = fnv1a(std::string(C::name).append("/").append(label));
    list.all.push_back(std::move(constraint));
    list.labels.push_back(std::move(label));
    list.keys.push_back(key);
  }

  template <Constraint C>
  ConstraintListOf<C>& list_of() {
    for (auto& list : lists_)
      if (auto* mine = dynamic_cast<ConstraintListOf<C>*>(list.get())) return *mine;
    lists_.push_back(std::make_unique<ConstraintListOf<C>>());
    return static_cast<ConstraintListOf<C>&>(*lists_.back());
  }

  const std::vector<std::unique_ptr<ConstraintList>>& lists() const { return lists_; }

 private:
  void require_bodies(std::string_view type, const BodyId* id, int count) const {
    const auto known = [&](BodyId b) { return b >= 0 && at(b) < bodies.size(); };
    for (int i = 0; i < count; ++i)
      if (!known(id[i]) || (i > 0 && id[i] == id[0]))
        throw std::invalid_argument(std::string(type) + " on body " + std::to_string(id[i]) + ": " +
                                    (known(id[i]) ? "it needs two different bodies" : "there are ") +
                                    (known(id[i]) ? "" : std::to_string(bodies.size()) + " bodies"));
  }

  std::vector<std::unique_ptr<ConstraintList>> lists_ = {};
};

}  // namespace zwang
