import {library, serve, version} from './protocol.mjs';
const Jolt = await (await library('jolt-physics', 'dist/jolt-physics.wasm-compat.js')).default();

const xyz = ([x, y, z]) => new Jolt.Vec3(x, y, z), rxyz = ([x, y, z]) => new Jolt.RVec3(x, y, z);
const turn = ([w, x, y, z]) => new Jolt.Quat(x, y, z, w), list = v => [v.GetX(), v.GetY(), v.GetZ()];
const shapes = {
  plane: () => new Jolt.PlaneShapeSettings(new Jolt.Plane(xyz([0, 0, 1]), 0)),
  sphere: s => new Jolt.SphereShapeSettings(s.radius),
  box: s => new Jolt.BoxShapeSettings(xyz(s.half), Math.min(0.05, ...s.half)),
};
const kinds = {free: Jolt.EMotionType_Dynamic, fixed: Jolt.EMotionType_Static, driven: Jolt.EMotionType_Kinematic};

// A body's shape, with the centre of mass where its own frame is.
function shape_of(body) {
  const all = new Jolt.StaticCompoundShapeSettings();
  for (const s of body.shapes) all.AddShapeShapeSettings(xyz(s.at), turn([1, 0, 0, 0]), shapes[s.kind](s), 0);
  const settings = body.shapes.length === 1 ? shapes[body.shapes[0].kind](body.shapes[0]) : all, made = settings.Create().Get();
  const middle = list(made.GetCenterOfMass());
  return body.motion !== 'free' || middle.every(x => x === 0) ? made :
    new Jolt.OffsetCenterOfMassShapeSettings(xyz(middle.map(x => -x)), settings).Create().Get();
}

serve({engine: 'jolt', version: version('jolt-physics'), licence: 'MIT', bits: 32, order: 1}, (scene, tuned) => {
  const settings = new Jolt.JoltSettings(), pairs = new Jolt.ObjectLayerPairFilterTable(1), layers = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
  pairs.EnableCollision(0, 0);
  layers.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
  settings.mObjectLayerPairFilter = pairs;
  settings.mBroadPhaseLayerInterface = layers;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 1, pairs, 1);
  const jolt = new Jolt.JoltInterface(settings), system = jolt.GetPhysicsSystem(), all = system.GetBodyInterface();
  system.SetGravity(xyz(scene.gravity));
  const physics = system.GetPhysicsSettings();
  if (tuned) Object.assign(physics, {mNumVelocitySteps: 200, mNumPositionSteps: 20, mPenetrationSlop: 0, mMinVelocityForRestitution: 0});
  system.SetPhysicsSettings(physics);
  const bodies = scene.bodies.map(b => {
    const made = new Jolt.BodyCreationSettings(shape_of(b), rxyz(b.at), turn(b.turn), kinds[b.motion], 0);
    Object.assign(made, {mLinearVelocity: xyz(b.velocity), mAngularVelocity: xyz(b.spin), mLinearDamping: 0, mAngularDamping: 0, mAllowSleeping: false,
      mFriction: scene.mu, mRestitution: scene.restitution, mApplyGyroscopicForce: tuned, mOverrideMassProperties: Jolt.EOverrideMassProperties_MassAndInertiaProvided});
    made.mMassPropertiesOverride.mMass = b.mass;
    made.mMassPropertiesOverride.mInertia = Jolt.Mat44.prototype.sScaleVec3(xyz(b.inertia));
    const body = all.CreateBody(made);
    all.AddBody(body.GetID(), Jolt.EActivation_Activate);
    return body;
  });
  for (const {a, b, at} of scene.joints) {
    const joint = new Jolt.PointConstraintSettings();
    joint.mPoint1 = joint.mPoint2 = rxyz(at);
    system.AddConstraint(joint.Create(b < 0 ? Jolt.JoltInterface.prototype.sGetFixedToWorldBody() : bodies[b], bodies[a]));
  }
  const pushed = scene.bodies.map((b, i) => ({id: bodies[i].GetID(), force: xyz(b.force), torque: xyz(b.torque)})).filter((_, i) => scene.bodies[i].motion === 'free');
  return {
    step() {
      for (const {id, force, torque} of pushed) all.AddForce(id, force, Jolt.EActivation_Activate), all.AddTorque(id, torque, Jolt.EActivation_Activate);
      jolt.Step(scene.dt, 1);
    },
    free: () => Jolt.destroy(jolt),  // its memory is fixed, and few worlds fill it
    states: () => bodies.map(body => {
      const q = body.GetRotation();
      return [...list(body.GetPosition()), q.GetW(), q.GetX(), q.GetY(), q.GetZ(), ...list(body.GetLinearVelocity()), ...list(body.GetAngularVelocity())];
    }),
  };
});
