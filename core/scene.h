#pragma once

#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/constraint.h"

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

// One constraint's rows, as the scene hands them to the assembly. The pointers live until the next linearization.
struct RowBlock {
  std::size_t item;  // of its list
  RowKind kind;
  int rows;                  // 1..6
  int arity;                 // 1 or 2
  const BodyId* bodies;      // arity
  const double* value;       // rows
  const double* jacobian;    // rows x 6*arity, column-major
  const double* compliance;  // rows, or null: all hard
};

// Constraints are held by type, one vector each: one virtual call a type, none a constraint.
class ConstraintList {
 public:
  virtual ~ConstraintList() = default;
  virtual std::unique_ptr<ConstraintList> clone() const = 0;
  virtual std::string_view type() const = 0;
  virtual std::size_t size() const = 0;
  virtual const std::string& label(std::size_t i) const = 0;
  virtual std::uint64_t key(std::size_t i) const = 0;
  // Linearizes all active constraints at the bodies' poses, in order. The blocks' storage is reused: no allocation
  // after warm-up.
  virtual const std::vector<RowBlock>& linearize_all(const std::vector<Body>& bodies) = 0;
  // The blocks of the last linearization.
  virtual const std::vector<RowBlock>& blocks() const = 0;
};

template <Constraint C>
class ConstraintListOf final : public ConstraintList {
 public:
  std::unique_ptr<ConstraintList> clone() const override { return std::make_unique<ConstraintListOf>(*this); }
  std::string_view type() const override { return C::name; }
  std::size_t size() const override { return all.size(); }
  const std::string& label(std::size_t i) const override { return labels[i]; }
  std::uint64_t key(std::size_t i) const override { return keys[i]; }
  const std::vector<RowBlock>& linearize_all(const std::vector<Body>& bodies) override {
    blocks_.clear();
    linear_.resize(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      PosesOf<C, double> q;
      for (std::size_t b = 0; b < q.size(); ++b) q[b] = bodies[static_cast<std::size_t>(all[i].bodies[b])].pose;
      if (!is_active(all[i], q)) continue;
      auto& [linear, compliance] = linear_[i];
      linear = linearize(all[i], q);
      if constexpr (HasCompliance<C>) compliance = all[i].compliance();
      blocks_.push_back({i, C::kind, C::rows, arity<C>, all[i].bodies.data(), linear.value.data(),
                         linear.jacobian.data(), HasCompliance<C> ? compliance.data() : nullptr});
    }
    return blocks_;
  }
  const std::vector<RowBlock>& blocks() const override { return blocks_; }

  std::vector<C> all = {};
  std::vector<std::string> labels = {};
  std::vector<std::uint64_t> keys = {};

 private:
  struct Rows {
    Linearization<C> linear;
    Vec<double, C::rows> compliance;
  };
  std::vector<Rows> linear_ = {};
  std::vector<RowBlock> blocks_ = {};
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
    require_bodies(C::name, constraint.bodies.data(), arity<C>);
    auto& list = list_of<C>();
    if (label.empty()) label = std::to_string(list.all.size());
    if (key == 0) key = hash_name(std::string(C::name) + "/" + label);
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
    const auto known = [&](BodyId b) { return b >= 0 && static_cast<std::size_t>(b) < bodies.size(); };
    for (int i = 0; i < count; ++i)
      if (!known(id[i]) || (i > 0 && id[i] == id[0]))
        throw std::invalid_argument(std::string(type) + " on body " + std::to_string(id[i]) + ": " +
                                    (known(id[i]) ? "it needs two different bodies" : "there are ") +
                                    (known(id[i]) ? "" : std::to_string(bodies.size()) + " bodies"));
  }

  // FNV-1a.
  static std::uint64_t hash_name(const std::string& text) {
    std::uint64_t h = 1469598103934665603ull;
    for (const unsigned char ch : text) h = (h ^ ch) * 1099511628211ull;
    return h;
  }

  std::vector<std::unique_ptr<ConstraintList>> lists_ = {};
};

}  // namespace zwang
