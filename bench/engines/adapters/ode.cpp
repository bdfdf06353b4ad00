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

  explicit Ode(const Scene& given) : World(given) {
    dWorldSetGravity(world, scene.gravity[0], scene.gravity[1], scene.gravity[2]);
    for (const Body& b : scene.bodies) {
      dBodyID body = bodies.emplace_back(dBodyCreate(world));
      dMass mass;
      dMassSetParameters(&mass, b.mass, 0, 0, 0, b.inertia[0], b.inertia[1], b.inertia[2], 0, 0, 0);
      dBodySetMass(body, &mass);
      dBodySetPosition(body, b.at[0], b.at[1], b.at[2]), dBodySetQuaternion(body, b.turn.data());
      dBodySetLinearVel(body, b.velocity[0], b.velocity[1], b.velocity[2]),
          dBodySetAngularVel(body, b.spin[0], b.spin[1], b.spin[2]);
      if (!b.free()) dBodySetKinematic(body);
      for (const Shape& s : b.shapes) {
        dVector3 n;
        dBodyVectorToWorld(body, 0, 0, 1, n);
        dGeomID geom = s.kind == "sphere" ? dCreateSphere(space, s.radius)
                       : s.kind == "box"
                           ? dCreateBox(space, 2 * s.half[0], 2 * s.half[1], 2 * s.half[2])
                           : dCreatePlane(space, n[0], n[1], n[2], n[0] * b.at[0] + n[1] * b.at[1] + n[2] * b.at[2]);
        if (s.kind != "plane") dGeomSetBody(geom, body), dGeomSetOffsetPosition(geom, s.at[0], s.at[1], s.at[2]);
      }
    }
    for (const Joint& j : scene.joints) {
      dJointID joint = dJointCreateBall(world, nullptr);
      dJointAttach(joint, bodies[j.a], j.b < 0 ? nullptr : bodies[j.b]),
          dJointSetBallAnchor(joint, j.at[0], j.at[1], j.at[2]);
    }
  }

  static void touch(void* self, dGeomID a, dGeomID b) {
    auto& ode = *static_cast<Ode*>(self);
    dContact points[16] = {};
    for (dContact& point : std::span(points, dCollide(a, b, 16, &points[0].geom, sizeof(dContact)))) {
      point.surface.mode = dContactApprox1 | dContactBounce;  // mu is a ratio of forces: of a pyramid
      point.surface.mu = ode.scene.mu, point.surface.bounce = ode.scene.restitution;
      dJointAttach(dJointCreateContact(ode.world, ode.contacts, &point), dGeomGetBody(a), dGeomGetBody(b));
    }
  }

  void step() override {
    dSpaceCollide(space, this, touch);
    for (int i = 0; i < scene.size(); ++i) {
      const Triple &f = scene.bodies[i].force, &t = scene.bodies[i].torque;
      dBodyAddForce(bodies[i], f[0], f[1], f[2]), dBodyAddTorque(bodies[i], t[0], t[1], t[2]);
    }
    scene.tuned ? dWorldStep(world, scene.dt) : dWorldQuickStep(world, scene.dt);
    dJointGroupEmpty(contacts);
  }

  State state(int i) const override {
    const dReal* q = dBodyGetQuaternion(bodies[i]);
    return {triple(dBodyGetPosition(bodies[i])),
            {q[0], q[1], q[2], q[3]},
            triple(dBodyGetLinearVel(bodies[i])),
            triple(dBodyGetAngularVel(bodies[i]))};
  }
};

}  // namespace

int main() {
  dInitODE2(0);
  return serve<Ode>({.engine = "ode", .version = "0.16.2", .licence = "BSD-3-Clause or LGPL-2.1+"});
}
