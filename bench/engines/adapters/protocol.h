#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

// The protocol of docs/engines.md for engines of C++. Lengths in m, masses in kg, turns as (w, x, y, z), all from the
// world.
namespace zwang::engines {

using Triple = std::array<double, 3>;
using Turn = std::array<double, 4>;

// Another library's vector.
template <class Vector>
Vector as(const Triple& t) {
  return Vector(t[0], t[1], t[2]);
}
// A library's quaternion of (w, x, y, z); one whose numbers have names or places, back.
template <class Quaternion>
Quaternion turn_as(const Turn& t) {
  return Quaternion(t[0], t[1], t[2], t[3]);
}
template <class Quaternion>
auto turn(const Quaternion& q, int /*preferred*/) -> decltype(q.w(), Turn()) {
  return {q.w(), q.x(), q.y(), q.z()};
}
template <class Quaternion>
Turn turn(const Quaternion& q, long /*otherwise*/) {
  return {q[0], q[1], q[2], q[3]};
}
// Calls set(object, x, y, z).
template <class Set, class Object>
void spread(Set set, Object object, const Triple& t) {
  set(object, t[0], t[1], t[2]);
}
inline Triple minus(const Triple& a, const Triple& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

struct Shape {
  std::string kind;  // plane (z <= 0 of the body's frame), sphere, box
  Triple at{}, half{};
  double radius = 0;
};

struct Body {
  std::string motion;  // free, fixed, driven (keeps its velocity)
  double mass = 0;
  Triple inertia{}, at{}, velocity{}, spin{}, force{}, torque{};
  Turn turn{};
  std::vector<Shape> shapes;

  bool free() const { return motion == "free"; }
};

// Two bodies share a point; b is -1 for the world.
struct Joint {
  int a = 0, b = -1;
  Triple at{};
};

struct Scene {
  double dt = 0, mu = 0, restitution = 0;
  Triple gravity{};
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::string mjcf;    // the whole scene as MuJoCo reads it, where the hello asked for it
  bool tuned = false;  // the engine's best setting for the question, not its default

  int size() const { return static_cast<int>(bodies.size()); }
  // A point of the world as a body sees it that is not turned; as the world does for -1.
  Triple seen_from(int body, const Triple& at) const { return body < 0 ? at : minus(at, bodies[body].at); }
  // The joint by which a body hangs on an earlier one or on the world; null where it is free.
  const Joint* holds(int body) const {
    for (const Joint& joint : joints)
      if (joint.a == body) return &joint;
    return nullptr;
  }
};

using State = std::array<double, 13>;  // position, turn, velocity, spin

template <class At, class Quaternion, class Velocity, class Spin>
State state_of(const At& at, const Quaternion& q, const Velocity& velocity, const Spin& spin) {
  const Turn t = turn(q, 0);
  return {at[0],       at[1],       at[2],       t[0],    t[1],    t[2],   t[3],
          velocity[0], velocity[1], velocity[2], spin[0], spin[1], spin[2]};
}

// An engine's world.
class World {
 public:
  explicit World(Scene given) : scene(std::move(given)) {}
  virtual ~World() = default;
  void step() {
    for (int i = 0; i < scene.size(); ++i) push(i, scene.bodies[i]);
    advance();
  }
  virtual void push(int /*body*/, const Body&) {}  // what has to be said in every step
  virtual void advance() = 0;
  virtual State state(int body) const = 0;

  const Scene scene;
};

// What an adapter says first. order: 1 where positions move with the new velocity, -1 with the old one, 0 as in
// continuous time; a step is `substeps` steps of the solver, in the default and the tuned setting.
struct Hello {
  std::string engine, version, licence;
  int bits = 64, order = 1;
  std::array<int, 2> substeps{1, 1};
  std::vector<std::string> lacks = {};  // of LACKING in engines.py
  bool mjcf = false;                    // scenes shall hold it
  bool alone = false;                   // numbers depend on what the process did before: a process for each scene
};

// Answers lines of stdin on stdout until they end.
int serve(const Hello& hello, const std::function<std::unique_ptr<World>(const Scene&)>& make);

template <class Engine>
int serve(const Hello& hello) {
  return serve(hello, [](const Scene& scene) { return std::make_unique<Engine>(scene); });
}

}  // namespace zwang::engines
