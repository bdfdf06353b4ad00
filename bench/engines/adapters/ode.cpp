#include <ode/ode.h>
#include <span>

#include <zwang/bench/engines/adapters/protocol.h>

using namespace zwang::engines;

namespace {

struct Ode : World {
  dWorldID world = dWorldCreate();
  dSpaceID space = dSimpleSpaceCreate(nullptr);
  dJointGroupID contacts = dJointGroupCreate(0);
  std::vector<dBodyID> bodies;

  static dGeomID made(dSpaceID space, const Shape& s, const dReal* normal, const Triple& at) {
    if (s.kind == "sphere") return dCreateSphere(space, s.radius);
    if (s.kind == "box") return dCreateBox(space, 2 * s.half[0], 2 * s.half[1], 2 * s.half[2]);
    return dCreatePlane(space, normal[0], normal[1], normal[2], dCalcVectorDot3(normal, at.data()));
  }

  explicit Ode(const Scene& given) : World(given) {
    dRandSetSeed(0);  // of the order in which QuickStep takes the rows
    spread(dWorldSetGravity, world, scene.gravity);
    for (const Body& b : scene.bodies) {
      dBodyID body = bodies.emplace_back(dBodyCreate(world));
      dMass mass;
      dMassSetParameters(&mass, b.mass, 0, 0, 0, b.inertia[0], b.inertia[1], b.inertia[2], 0, 0, 0);
      dBodySetMass(body, &mass), dBodySetQuaternion(body, b.turn.data()), spread(dBodySetPosition, body, b.at);
      spread(dBodySetLinearVel, body, b.velocity), spread(dBodySetAngularVel, body, b.spin);
      if (!b.free()) dBodySetKinematic(body);
      for (const Shape& s : b.shapes) {
        dVector3 up;
        dBodyVectorToWorld(body, 0, 0, 1, up);
        const dGeomID geom = made(space, s, up, b.at);
        if (s.kind != "plane") dGeomSetBody(geom, body), spread(dGeomSetOffsetPosition, geom, s.at);
      }
    }
    for (const Joint& j : scene.joints) {
      const dJointID joint = dJointCreateBall(world, nullptr);
      dJointAttach(joint, bodies[j.a], j.b < 0 ? nullptr : bodies[j.b]), spread(dJointSetBallAnchor, joint, j.at);
    }
  }

  static void touch(void* self, dGeomID a, dGeomID b) {
    const auto& ode = *static_cast<Ode*>(self);
    dContact points[16] = {};
    for (dContact& point : std::span(points, dCollide(a, b, 16, &points[0].geom, sizeof(dContact)))) {
      point.surface.mode = dContactApprox1 | dContactBounce;  // mu is a ratio of forces: of a pyramid
      point.surface.mu = ode.scene.mu, point.surface.bounce = ode.scene.restitution;
      dJointAttach(dJointCreateContact(ode.world, ode.contacts, &point), dGeomGetBody(a), dGeomGetBody(b));
    }
  }

  void push(int i, const Body& b) override {
    spread(dBodyAddForce, bodies[i], b.force), spread(dBodyAddTorque, bodies[i], b.torque);
  }
  void advance() override {
    dSpaceCollide(space, this, touch);
    (scene.tuned ? dWorldStep : dWorldQuickStep)(world, scene.dt);
    dJointGroupEmpty(contacts);
  }

  State state(int i) const override {
    const dBodyID b = bodies[i];
    return state_of(dBodyGetPosition(b), dBodyGetQuaternion(b), dBodyGetLinearVel(b), dBodyGetAngularVel(b));
  }
};

}  // namespace

int main() {
  return dInitODE2(0), serve<Ode>({.engine = "ode", .version = "0.16.2", .licence = "BSD-3-Clause or LGPL-2.1+"});
}
