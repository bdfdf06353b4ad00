import {library, serve, version} from './protocol.mjs';
const {Body, Box, Plane, PointToPointConstraint, Quaternion, Sphere, Vec3, World} = await library('cannon-es');

const shapes = {
  plane: () => new Plane(),
  sphere: s => new Sphere(s.radius),
  box: s => new Box(new Vec3(...s.half)),
};
const kinds = {free: Body.DYNAMIC, fixed: Body.STATIC, driven: Body.KINEMATIC};
const turn = ([w, x, y, z]) => new Quaternion(x, y, z, w);

serve({engine: 'cannon-es', version: version('cannon-es'), licence: 'MIT', bits: 64, order: 1}, (scene, tuned) => {
  const world = new World({gravity: new Vec3(...scene.gravity)});
  world.defaultContactMaterial.friction = scene.mu;
  world.defaultContactMaterial.restitution = scene.restitution;
  if (tuned) {
    world.solver.iterations = 100;
    world.solver.tolerance = 0;
    // The bound of friction is a force, and the solver's numbers are impulses; and each point has that of the whole body.
    world.frictionGravity = world.gravity.scale(scene.dt);
    world.narrowphase.enableFrictionReduction = true;
    world.defaultContactMaterial.contactEquationStiffness = world.defaultContactMaterial.frictionEquationStiffness = 1e9;
  }
  const bodies = scene.bodies.map(b => {
    const body = new Body({
      mass: b.motion === 'free' ? b.mass : 0, type: kinds[b.motion], position: new Vec3(...b.at), quaternion: turn(b.turn),
      velocity: new Vec3(...b.velocity), angularVelocity: new Vec3(...b.spin), linearDamping: 0, angularDamping: 0,
    });
    for (const s of b.shapes) body.addShape(shapes[s.kind](s), new Vec3(...s.at));
    if (b.motion === 'free') {
      body.inertia.set(...b.inertia);
      body.invInertia.set(...b.inertia.map(i => 1 / i));
      body.updateInertiaWorld(true);
    }
    world.addBody(body);
    return body;
  });
  for (const {a, b, at} of scene.joints) {
    const first = bodies[a], other = b < 0 ? new Body({mass: 0}) : bodies[b], point = new Vec3(...at);
    world.addConstraint(new PointToPointConstraint(first, first.pointToLocalFrame(point), other, other.pointToLocalFrame(point)));
  }
  return {
    step() {
      scene.bodies.forEach((b, i) => {
        bodies[i].force.set(...b.force);
        bodies[i].torque.set(...b.torque);
      });
      world.step(scene.dt);
    },
    states: () => bodies.map(({position: p, quaternion: q, velocity: v, angularVelocity: w}) =>
      [...p.toArray(), q.w, q.x, q.y, q.z, ...v.toArray(), ...w.toArray()]),
  };
});
