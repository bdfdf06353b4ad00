import {library, minus, serve, version} from './protocol.mjs';
const name = '@dimforge/rapier3d-compat';
const RAPIER = (await library(name)).default;
await RAPIER.init();

const xyz = ([x, y, z]) => ({x, y, z}), list = ({x, y, z}) => [x, y, z];
const shapes = {
  plane: () => new RAPIER.ColliderDesc(new RAPIER.HalfSpace({x: 0, y: 0, z: 1})),
  sphere: s => RAPIER.ColliderDesc.ball(s.radius),
  box: s => RAPIER.ColliderDesc.cuboid(...s.half),
};
const kinds = {free: 'dynamic', fixed: 'fixed', driven: 'kinematicVelocityBased'};

// A step is as many steps of the solver as it has iterations.
serve({engine: 'rapier', version: version(name), licence: 'Apache-2.0', bits: 32, order: 1, substeps: {default: 4, tuned: 16}}, (scene, tuned) => {
  const world = new RAPIER.World(xyz(scene.gravity));
  world.timestep = scene.dt;
  if (tuned) {
    world.integrationParameters.numSolverIterations = 16;
    world.integrationParameters.numInternalPgsIterations = 8;
    world.integrationParameters.normalizedAllowedLinearError = 0;
  }
  const bodies = scene.bodies.map(b => {
    const [w, x, y, z] = b.turn;
    const body = world.createRigidBody(RAPIER.RigidBodyDesc[kinds[b.motion]]().setTranslation(...b.at).setRotation({w, x, y, z})
      .setLinvel(...b.velocity).setAngvel(xyz(b.spin)).setCanSleep(false).setLinearDamping(0).setAngularDamping(0));
    if (b.motion === 'free') body.setAdditionalMassProperties(b.mass, xyz([0, 0, 0]), xyz(b.inertia), {w: 1, x: 0, y: 0, z: 0}, true);
    for (const s of b.shapes)
      world.createCollider(shapes[s.kind](s).setDensity(0).setTranslation(...s.at).setFriction(scene.mu).setRestitution(scene.restitution), body);
    body.addForce(xyz(b.force), true);
    body.addTorque(xyz(b.torque), true);
    return body;
  });
  const earth = world.createRigidBody(RAPIER.RigidBodyDesc.fixed());
  for (const {a, b, at} of scene.joints) {
    const first = bodies[a], other = b < 0 ? earth : bodies[b];
    const from = body => xyz(minus(at, list(body.translation())));  // joints are made where bodies are not turned
    world.createImpulseJoint(RAPIER.JointData.spherical(from(first), from(other)), first, other, true);
  }
  return {
    step: () => world.step(),
    free: () => world.free(),
    states: () => bodies.map(body => {
      const q = body.rotation();
      return [...list(body.translation()), q.w, q.x, q.y, q.z, ...list(body.linvel()), ...list(body.angvel())];
    }),
  };
});
