#include <Simbody.h>
#include <map>

#include <zwang/bench/engines/adapters/protocol.h>

namespace {

namespace zw = zwang::engines;
using zw::as, zw::Triple, zw::triple;
using namespace SimTK;

struct Simbody : zw::World {
  MultibodySystem system;
  SimbodyMatterSubsystem matter{system};
  GeneralForceSubsystem forces{system};
  ContactTrackerSubsystem tracker{system};
  CompliantContactSubsystem contacts{system, tracker};
  std::map<int, MobilizedBody> bodies;
  RungeKuttaMersonIntegrator integrator{system};
  TimeStepper stepper{system, integrator};

  // It has spheres and half-spaces, which deform; a box has small spheres in its corners.
  Body made(const zw::Body& b) const {
    Body::Rigid body(MassProperties(b.mass, Vec3(0), Inertia(as<Vec3>(b.inertia))));
    const ContactMaterial material(scene.tuned ? 1e8 : 1e7, scene.tuned ? 10 : 0.5, scene.mu, scene.mu, 0);
    const auto sphere = [&](const Vec3& at, double r) {
      body.addContactSurface(at, ContactSurface(ContactGeometry::Sphere(r), material));
    };
    for (const zw::Shape& s : b.shapes) {
      if (s.kind == "plane")
        body.addContactSurface(Rotation(Pi / 2, YAxis), ContactSurface(ContactGeometry::HalfSpace(), material));
      if (s.kind == "sphere") sphere(as<Vec3>(s.at), s.radius);
      const Vec3 corner = as<Vec3>(s.half) - Vec3(1e-3);
      for (int k = 0; s.kind == "box" && k < 8; ++k)
        sphere(corner.elementwiseMultiply(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)), 1e-3);
    }
    return body;
  }

  // A body, and then those that hang on it by a joint: these have no other freedom.
  void add(int i) {
    const zw::Body& b = scene.bodies[i];
    const zw::Joint* joint = scene.holds(i);
    const Transform at(Rotation(Quaternion(b.turn[0], b.turn[1], b.turn[2], b.turn[3])), as<Vec3>(b.at));
    MobilizedBody& parent =
        joint && joint->b >= 0 ? bodies.at(joint->b) : static_cast<MobilizedBody&>(matter.updGround());
    if (joint) {
      const Vec3 from = as<Vec3>(zw::minus(joint->at, joint->b < 0 ? Triple{} : scene.bodies[joint->b].at));
      bodies[i] = MobilizedBody::Ball(parent, from, made(b), as<Vec3>(zw::minus(joint->at, b.at)));
    } else if (b.free())
      bodies[i] = MobilizedBody::Free(parent, Transform(), made(b), Transform());
    else
      bodies[i] = MobilizedBody::Weld(parent, at, made(b), Transform());
    Force::ConstantForce(forces, bodies[i], Vec3(0), as<Vec3>(b.force)),
        Force::ConstantTorque(forces, bodies[i], as<Vec3>(b.torque));
    for (const zw::Joint& j : scene.joints)
      if (j.b == i) add(j.a);
  }

  explicit Simbody(const zw::Scene& given) : zw::World(given) {
    if (scene.restitution > 0) throw zw::Absent("coefficient of restitution");
    Force::UniformGravity(forces, matter, as<Vec3>(scene.gravity));
    contacts.setTransitionVelocity(scene.tuned ? 1e-3 : 1e-2);
    int boxes = 0;
    for (int i = 0; i < scene.size(); ++i) {
      if (scene.bodies[i].motion == "driven") throw zw::Absent("driven bodies");
      if (scene.bodies[i].shapes[0].kind == "box" && ++boxes > 1) throw zw::Absent("boxes that touch each other");
      if (!scene.holds(i) || scene.holds(i)->b < 0) add(i);
    }
    State start = system.realizeTopology();
    for (auto& [i, body] : bodies) {
      const zw::Body& b = scene.bodies[i];
      if (b.free()) body.setQToFitTransform(start, as<Vec3>(b.at)), system.realize(start, Stage::Position);
      if (b.free()) body.setUToFitVelocity(start, SpatialVec(as<Vec3>(b.spin), as<Vec3>(b.velocity)));
    }
    integrator.setAccuracy(scene.tuned ? 1e-5 : 1e-3);
    stepper.initialize(start);
  }

  void step() override { stepper.stepTo(stepper.getTime() + scene.dt); }

  zw::State state(int i) const override {
    const State& now = stepper.getState();
    system.realize(now, Stage::Velocity);
    const MobilizedBody& b = bodies.at(i);
    const Quaternion q = b.getBodyRotation(now).convertRotationToQuaternion();
    return {triple(b.getBodyOriginLocation(now)),
            {q[0], q[1], q[2], q[3]},
            triple(b.getBodyOriginVelocity(now)),
            triple(b.getBodyAngularVelocity(now))};
  }
};

}  // namespace

int main() { return zw::serve<Simbody>({.engine = "simbody", .version = "3.7", .licence = "Apache-2.0", .order = 0}); }
