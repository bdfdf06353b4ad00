#include <Simbody.h>

#include <zwang/bench/engines/adapters/protocol.h>

namespace {

namespace zw = zwang::engines;
using zw::triple;
using namespace SimTK;
const auto vector = zw::as<Vec3>;

struct Simbody : zw::World {
  MultibodySystem system;
  SimbodyMatterSubsystem matter{system};
  GeneralForceSubsystem forces{system};
  ContactTrackerSubsystem tracker{system};
  CompliantContactSubsystem contacts{system, tracker};
  std::vector<MobilizedBody> bodies;
  RungeKuttaMersonIntegrator integrator{system};
  TimeStepper stepper{system, integrator};

  // It has spheres and half-spaces, which deform; a box has small spheres in its corners.
  Body made(const zw::Body& b) const {
    Body::Rigid body(MassProperties(b.mass, Vec3(0), Inertia(vector(b.inertia))));
    const ContactMaterial material(scene.tuned ? 1e8 : 1e7, scene.tuned ? 10 : 0.5, scene.mu, scene.mu, 0);
    const auto sphere = [&](const Vec3& at, double r) {
      body.addContactSurface(at, ContactSurface(ContactGeometry::Sphere(r), material));
    };
    for (const zw::Shape& s : b.shapes) {
      if (s.kind == "plane")
        body.addContactSurface(Rotation(Pi / 2, YAxis), ContactSurface(ContactGeometry::HalfSpace(), material));
      if (s.kind == "sphere") sphere(vector(s.at), s.radius);
      const Vec3 corner = vector(s.half) - Vec3(1e-3);
      for (int k = 0; s.kind == "box" && k < 8; ++k)
        sphere(corner.elementwiseMultiply(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)), 1e-3);
    }
    return body;
  }

  explicit Simbody(const zw::Scene& given) : zw::World(given) {
    if (scene.restitution > 0) throw zw::Absent("coefficient of restitution");
    Force::UniformGravity(forces, matter, vector(scene.gravity));
    contacts.setTransitionVelocity(scene.tuned ? 1e-3 : 1e-2);
    int boxes = 0;
    for (const zw::Body& b : scene.bodies) {
      if (b.motion == "driven") throw zw::Absent("driven bodies");
      if (b.shapes[0].kind == "box" && ++boxes > 1) throw zw::Absent("boxes that touch each other");
      // Bodies that hang on others have no other freedom.
      const zw::Joint* joint = scene.holds(static_cast<int>(bodies.size()));
      MobilizedBody& parent =
          joint && joint->b >= 0 ? bodies[joint->b] : static_cast<MobilizedBody&>(matter.updGround());
      const Vec3 from =
          joint ? vector(zw::minus(joint->at, joint->b < 0 ? zw::Triple{} : scene.bodies[joint->b].at)) : Vec3(0);
      if (joint)
        bodies.push_back(MobilizedBody::Ball(parent, from, made(b), vector(zw::minus(joint->at, b.at))));
      else if (b.free())
        bodies.push_back(MobilizedBody::Free(parent, Transform(), made(b), Transform()));
      else
        bodies.push_back(MobilizedBody::Weld(
            parent, Transform(Rotation(Quaternion(b.turn[0], b.turn[1], b.turn[2], b.turn[3])), vector(b.at)), made(b),
            Transform()));
      Force::ConstantForce(forces, bodies.back(), Vec3(0), vector(b.force)),
          Force::ConstantTorque(forces, bodies.back(), vector(b.torque));
    }
    State start = system.realizeTopology();
    for (int i = 0; i < scene.size(); ++i) {
      const zw::Body& b = scene.bodies[i];
      if (b.free()) bodies[i].setQToFitTransform(start, vector(b.at)), system.realize(start, Stage::Position);
      if (b.free()) bodies[i].setUToFitVelocity(start, SpatialVec(vector(b.spin), vector(b.velocity)));
    }
    integrator.setAccuracy(scene.tuned ? 1e-5 : 1e-3);
    stepper.initialize(start);
  }

  void step() override { stepper.stepTo(stepper.getTime() + scene.dt); }

  zw::State state(int i) const override {
    const State& now = stepper.getState();
    system.realize(now, Stage::Velocity);
    const MobilizedBody& b = bodies[i];
    const Quaternion q = b.getBodyRotation(now).convertRotationToQuaternion();
    return {triple(b.getBodyOriginLocation(now)),
            {q[0], q[1], q[2], q[3]},
            triple(b.getBodyOriginVelocity(now)),
            triple(b.getBodyAngularVelocity(now))};
  }
};

}  // namespace

int main() { return zw::serve<Simbody>({.engine = "simbody", .version = "3.7", .licence = "Apache-2.0", .order = 0}); }
