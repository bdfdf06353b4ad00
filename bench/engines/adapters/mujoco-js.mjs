import {Absent, library, minus, serve, version} from './protocol.mjs';
const name = '@mujoco/mujoco', mujoco = await (await library(name, 'mujoco.js')).default();

const text = numbers => numbers.join(' ');
const sizes = {plane: () => '0 0 1', sphere: s => s.radius, box: s => text(s.half)};

// A body, and inside it those that hang on it by a joint: these have no other freedom.
function body_of(scene, i, origin) {
  const b = scene.bodies[i], joint = scene.joints.find(j => j.a === i), axis = b.velocity.map(Math.sign);
  const motion = b.motion === 'fixed' ? '' : b.motion === 'driven' ? `<joint type="slide" axis="${text(axis)}" armature="1e12"/>` :
    joint ? `<joint type="ball" pos="${text(minus(joint.at, b.at))}"/>` : '<freejoint/>';
  const inside = scene.joints.filter(j => j.b === i).map(j => body_of(scene, j.a, b.at)).join('');
  const geoms = b.shapes.map(s => `<geom type="${s.kind}" size="${sizes[s.kind](s)}" pos="${text(s.at)}"/>`).join('');
  return `<body name="b${i}" pos="${text(minus(b.at, origin))}" quat="${text(b.turn)}">${motion}<inertial pos="0 0 0" mass="${b.mass}" diaginertia="${text(b.inertia)}"/>${geoms}${inside}</body>`;
}

function model_of(scene, tuned) {
  const option = tuned ? 'cone="elliptic" impratio="100" noslip_iterations="100" iterations="1000" tolerance="0"' : '';
  const geom = tuned ? `solref="${2 * scene.dt} 1" solimp="0.99 0.9999 0.001"` : '';
  const roots = scene.bodies.map((_, i) => scene.joints.some(j => j.a === i && j.b >= 0) ? '' : body_of(scene, i, [0, 0, 0])).join('');
  const sensors = scene.bodies.map((_, i) => ['pos', 'quat', 'linvel', 'angvel'].map(what => `<frame${what} objtype="xbody" objname="b${i}"/>`).join('')).join('');
  return `<mujoco><option timestep="${scene.dt}" gravity="${text(scene.gravity)}" ${option}/><default><geom friction="${scene.mu} 0 0" ${geom}/></default>
    <worldbody>${roots}</worldbody><sensor>${sensors}</sensor></mujoco>`;
}

serve({engine: 'mujoco-js', version: version(name), licence: 'Apache-2.0', bits: 64, order: 1}, (scene, tuned) => {
  if (scene.restitution) throw new Absent('coefficient of restitution');
  const model = mujoco.MjModel.from_xml_string(model_of(scene, tuned)), data = new mujoco.MjData(model);
  let at = 0;
  for (const [i, b] of scene.bodies.entries()) {
    data.xfrc_applied.set([...b.force, ...b.torque], 6 * (i + 1));
    // Spins are those of the world where bodies are not turned, as here at the start.
    const start = b.motion === 'fixed' ? [] : b.motion === 'driven' ? [Math.hypot(...b.velocity)] : scene.joints.some(j => j.a === i) ? b.spin : [...b.velocity, ...b.spin];
    data.qvel.set(start, at);
    at += start.length;
  }
  return {
    step: () => mujoco.mj_step(model, data),
    states() {
      for (const part of ['fwdPosition', 'sensorPos', 'fwdVelocity', 'sensorVel']) mujoco[`mj_${part}`](model, data);
      return scene.bodies.map((_, i) => Array.from(data.sensordata.slice(13 * i, 13 * i + 13)));
    },
  };
});
