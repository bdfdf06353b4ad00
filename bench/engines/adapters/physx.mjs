import {library, minus, read, serve, version} from './protocol.mjs';
// It is compiled for browsers alone, and looks for one.
const {process: node} = globalThis, file = 'physx-js-webidl.wasm', load = (await library('physx-js-webidl', 'physx-js-webidl.mjs')).default;
Object.assign(globalThis, {process: undefined, window: globalThis});
const PhysX = await load({wasmBinary: read('physx-js-webidl', file), locateFile: () => file});
globalThis.process = node;

const xyz = ([x, y, z]) => new PhysX.PxVec3(x, y, z), list = v => [v.x, v.y, v.z];
const pose = (at, [w, x, y, z]) => new PhysX.PxTransform(xyz(at), new PhysX.PxQuat(x, y, z, w));
const still = [0, 0, 0], straight = [1, 0, 0, 0], up = [Math.SQRT1_2, 0, -Math.SQRT1_2, 0];  // a plane faces along x
const shapes = {
  plane: () => new PhysX.PxPlaneGeometry(),
  sphere: s => new PhysX.PxSphereGeometry(s.radius),
  box: s => new PhysX.PxBoxGeometry(...s.half),
};
const flags = new PhysX.PxShapeFlags(PhysX.PxShapeFlagEnum.eSIMULATION_SHAPE);
const foundation = PhysX.CreateFoundation(PhysX.PHYSICS_VERSION, new PhysX.PxDefaultAllocator(), new PhysX.PxDefaultErrorCallback());
const scale = new PhysX.PxTolerancesScale(), physics = PhysX.CreatePhysics(PhysX.PHYSICS_VERSION, foundation, scale);

serve({engine: 'physx', version: version('physx-js-webidl'), licence: 'BSD-3-Clause (PhysX), MIT (its bindings)', bits: 32, order: 1}, (scene, tuned) => {
  const settings = new PhysX.PxSceneDesc(scale);
  Object.assign(settings, {gravity: xyz(scene.gravity), cpuDispatcher: PhysX.DefaultCpuDispatcherCreate(0), filterShader: PhysX.DefaultFilterShader()});
  if (tuned) Object.assign(settings, {bounceThresholdVelocity: 1e-3, solverType: PhysX.PxSolverTypeEnum.eTGS});
  const world = physics.createScene(settings), material = physics.createMaterial(scene.mu, scene.mu, scene.restitution);
  const bodies = scene.bodies.map(b => {
    const body = b.motion === 'fixed' ? physics.createRigidStatic(pose(b.at, b.turn)) : physics.createRigidDynamic(pose(b.at, b.turn));
    for (const s of b.shapes) {
      const shape = physics.createShape(shapes[s.kind](s), material, true, flags);
      shape.setLocalPose(pose(s.at, s.kind === 'plane' ? up : straight));
      shape.setSimulationFilterData(new PhysX.PxFilterData(1, 1, 0, 0));
      body.attachShape(shape);
    }
    if (b.motion === 'free') {
      const given = {Mass: b.mass, MassSpaceInertiaTensor: xyz(b.inertia), LinearVelocity: xyz(b.velocity), AngularVelocity: xyz(b.spin),
        LinearDamping: 0, AngularDamping: 0, SleepThreshold: 0, StabilizationThreshold: 0};
      for (const [what, value] of Object.entries(given)) body[`set${what}`](value);
      if (tuned) body.setSolverIterationCounts(100, 4);
    } else if (b.motion === 'driven') body.setRigidBodyFlag(PhysX.PxRigidBodyFlagEnum.eKINEMATIC, true);
    world.addActor(body);
    return body;
  });
  for (const {a, b, at} of scene.joints)
    PhysX.SphericalJointCreate(physics, bodies[a], pose(minus(at, scene.bodies[a].at), straight), b < 0 ? null : bodies[b],
      pose(minus(at, b < 0 ? still : scene.bodies[b].at), straight));
  const forces = scene.bodies.map(b => xyz(b.force)), torques = scene.bodies.map(b => xyz(b.torque));
  return {
    step() {
      scene.bodies.forEach((b, i) => {
        if (b.motion === 'free') bodies[i].addForce(forces[i]), bodies[i].addTorque(torques[i]);
        if (b.motion === 'driven')
          bodies[i].setKinematicTarget(pose(list(bodies[i].getGlobalPose().p).map((x, k) => x + b.velocity[k] * scene.dt), b.turn));
      });
      world.simulate(scene.dt);
      world.fetchResults(true);
    },
    free: () => world.release(),
    states: () => bodies.map((body, i) => {
      const {p, q} = body.getGlobalPose(), moves = scene.bodies[i].motion !== 'fixed';
      return [...list(p), q.w, q.x, q.y, q.z, ...(moves ? list(body.getLinearVelocity()) : still), ...(moves ? list(body.getAngularVelocity()) : still)];
    }),
  };
});
