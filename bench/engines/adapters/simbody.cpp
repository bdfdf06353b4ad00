#include <Simbody.h>

#include <zwang/bench/engines/adapters/protocol.h>

namespace {

namespace zw = zwang::engines;
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
    const auto add = [&](auto at, auto shape) { body.addContactSurface(at, ContactSurface(shape, material)); };
    for (const zw::Shape& s : b.shapes) {
      if (s.kind == "plane") add(Rotation(Pi / 2, YAxis), ContactGeometry::HalfSpace());
      if (s.kind == "sphere") add(vector(s.at), ContactGeometry::Sphere(s.radius));
      for (int k = 0; s.kind == "box" && k < 8; ++k) {
        const Vec3 corner(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
        add(corner.elementwiseMultiply(vector(s.half) - Vec3(1e-3)), ContactGeometry::Sphere(1e-3));
      }
    }
    return body;
  }

  // Bodies that hang on others have no other freedom.
  MobilizedBody hung(const zw::Body& b, const zw::Joint* joint) {
    MobilizedBody& ground = matter.updGround();
    const auto from = [&](int body) { return vector(scene.seen_from(body, joint->at)); };
    if (joint)
      return MobilizedBody::Ball(joint->b < 0 ? ground : bodies[joint->b], from(joint->b), made(b), from(joint->a));
    if (b.free()) return MobilizedBody::Free(ground, made(b));
    const Rotation turned(zw::turn_as<Quaternion>(b.turn));
    return MobilizedBody::Weld(ground, Transform(turned, vector(b.at)), made(b), Transform());
  }

  explicit Simbody(const zw::Scene& given) : zw::World(given) {
    Force::UniformGravity(forces, matter, vector(scene.gravity));
    contacts.setTransitionVelocity(scene.tuned ? 1e-3 : 1e-2);
    for (const zw::Body& b : scene.bodies) {
      const MobilizedBody& body = bodies.emplace_back(hung(b, scene.holds(static_cast<int>(bodies.size()))));
      Force::ConstantForce(forces, body, Vec3(0), vector(b.force));
      Force::ConstantTorque(forces, body, vector(b.torque));
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

  void advance() override { stepper.stepTo(stepper.getTime() + scene.dt); }

  zw::State state(int i) const override {
    const State& now = stepper.getState();
    system.realize(now, Stage::Velocity);
    const Transform& at = bodies[i].getBodyTransform(now);
    const SpatialVec& moves = bodies[i].getBodyVelocity(now);
    return zw::state_of(at.p(), at.R().convertRotationToQuaternion(), moves[1], moves[0]);
  }
};

}  // namespace

int main() {
  zw::Hello hello{.engine = "simbody", .version = "3.7", .licence = "Apache-2.0", .order = 0};
  hello.lacks = {"coefficient of restitution", "driven bodies", "boxes that touch each other"};
  return zw::serve<Simbody>(hello);
}
