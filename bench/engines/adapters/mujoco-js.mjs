import {library, serve, version} from './protocol.mjs';
const name = '@mujoco/mujoco', mujoco = await (await library(name, 'mujoco.js')).default();

serve({engine: 'mujoco-js', version: version(name), licence: 'Apache-2.0', bits: 64, order: 1, lacks: ['coefficient of restitution'], mjcf: true}, scene => {
  const model = mujoco.MjModel.from_xml_string(scene.mjcf), data = new mujoco.MjData(model);
  let at = 0;
  scene.bodies.forEach((b, i) => {
    data.xfrc_applied.set([...b.force, ...b.torque], 6 * (i + 1));
    const held = scene.joints.some(j => j.a === i), driven = b.motion === 'driven' ? [Math.hypot(...b.velocity)] : [];
    const start = b.motion === 'free' ? [...(held ? [] : b.velocity), ...b.spin] : driven;  // spins are the world's: no free body is turned at the start
    data.qvel.set(start, at);
    at += start.length;
  });
  return {
    step: () => mujoco.mj_step(model, data),
    free: () => [data, model].forEach(x => x.delete()),
    states() {
      for (const part of ['fwdPosition', 'sensorPos', 'fwdVelocity', 'sensorVel']) mujoco[`mj_${part}`](model, data);
      return scene.bodies.map((_, i) => Array.from(data.sensordata.slice(13 * i, 13 * i + 13)));
    },
  };
});
