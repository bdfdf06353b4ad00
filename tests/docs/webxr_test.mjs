// node webxr_test.mjs ZWANG EXAMPLE [PICTURE]: hand tracking in a browser. `live`, the bridge and its page in headless Chromium; the
// recorded joints are played, and the god hand comes back. With a PICTURE the page is left there, to be looked at.
import assert from 'node:assert/strict';
import {spawn} from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import {open_browser} from '../bench/report/chromium.mjs';

const [zwang, example, picture] = process.argv.slice(2);
const wait = milliseconds => new Promise(done => setTimeout(done, milliseconds));
const programs = [];
// Starts a program; when it has printed where it listens, the port.
const start = (...words) => new Promise((resolve, reject) => {
  const child = spawn(words[0], words.slice(1), {env: {...process.env, PYTHONDONTWRITEBYTECODE: '1'}});
  const program = {child, said: ''};
  programs.push(program);
  for (const stream of [child.stdout, child.stderr])
    stream.on('data', data => {
      program.said += data;
      const port = program.said.match(/(?:127\.0\.0\.1|localhost):(\d+)/);
      if (port) resolve(Object.assign(program, {port: +port[1]}));
    });
  child.on('exit', () => reject(new Error(program.said)));
});

joints_are_as_webxr_has_them();
const browser = await open_browser();
try {
  const live = await start(zwang, 'live', 'box', '--motion', path.join(example, 'rest.csv'), '--place', '0', '--listen', '0');
  const bridge = await start('/usr/bin/python3', path.join(example, 'bridge.py'), String(live.port), '0');
  const page = await browser.open_page(`http://localhost:${bridge.port}/`, {width: 200, height: 150});  // small: software draws slowly
  const until = async (what, seconds) => {
    for (const end = Date.now() + 1000 * seconds; !(await page.evaluate(what)); await wait(100))
      assert.ok(Date.now() < end, `${what}: not within ${seconds} s; ${await page.evaluate('by_id("fault").textContent')}`);
  };
  await until('state.frame && bones && recording', 30);
  assert.ok(await page.evaluate(`bones.phalanxes.every(([length], k) => {  // bones meet: the lengths are those of the model
    const tip = (pose, share) => pose.slice(0, 3).map((x, i) => x + share * axis(pose.slice(3))[i]);
    const axis = ([x, y, z, w]) => [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)];
    const next = bones.phalanxes[k + 1];
    return k % 3 === 2 || Math.hypot(...tip(state.frame.god[k + 1], length / 2).map((x, i) => x - tip(state.frame.god[k + 2], -next[0] / 2)[i])) < 1e-9;
  })`));
  await page.evaluate(`(() => {
    globalThis.seen = {frames: 0, contacts: 0, gap: Infinity, first: [...state.frame.god[0]], moved: 0, off: 0};
    const before = decoded;
    decoded = data => {
      const frame = before(data), palm = frame.god[0];
      ++seen.frames;
      seen.contacts = Math.max(seen.contacts, frame.contacts.filter(c => c[7] > 0).length);
      seen.gap = Math.min(seen.gap, ...frame.contacts.map(c => c[6]));
      seen.moved = Math.max(seen.moved, Math.hypot(...[0, 1, 2].map(i => palm[i] - seen.first[i])));
      seen.off = Math.max(seen.off, ...[0, 1, 2].map(i => Math.abs(palm[i] - frame.target[0][i])));
      return frame;
    };
    by_id('play').click();
  })()`);
  if (picture) {
    await until('played > 2', 120);
    await page.screenshot(picture);
  }
  await until('played * recording.rate > recording.frames.length', 240);
  const seen = await page.evaluate('seen');
  assert.ok(seen.frames > 50 && seen.moved > .25, `the god hand follows: ${JSON.stringify(seen)}`);
  assert.ok(seen.contacts > 0 && seen.gap > -1e-9, `touches, and is in nothing: ${JSON.stringify(seen)}`);
  const count = await page.evaluate('by_id("said").textContent');
  assert.match(count, /^[\d,]+ frames of live a second, \d+ shown; late, not answered until the next one: \d+ of \d+$/);
  await page.evaluate('by_id("enter").click()');
  await until('/^(This browser has no WebXR|No headset)/.test(by_id("fault").textContent)', 10);
  live.child.kill('SIGINT');
  await until('/^live (has ended|is not there): ..zwang live box --listen/.test(by_id("fault").textContent)', 30);
  await until('by_id("fault").textContent.startsWith("live is not there")', 30);
  bridge.child.kill();
  await until('by_id("fault").textContent.startsWith("The bridge is not there")', 30);
  console.log(`${count}; ${JSON.stringify(seen)}`);
} finally {
  await browser.close();
  for (const {child} of programs) child.kill();
}

// The recording has XRHand's joints, and its axes: a joint's -z points along its bone to the next joint; the wrist's x, y and -z to the
// little finger, out of the back of the right hand and to the fingers.
function joints_are_as_webxr_has_them() {
  const {joints, frames} = JSON.parse(fs.readFileSync(path.join(example, 'joints.json')));
  const fingers = ['thumb', ...['index', 'middle', 'ring', 'pinky'].map(name => `${name}-finger`)];
  assert.deepEqual(joints, ['wrist', ...fingers.flatMap(finger => ['metacarpal', 'phalanx-proximal', ...finger === 'thumb' ? [] : ['phalanx-intermediate'],
    'phalanx-distal', 'tip'].map(joint => `${finger}-${joint}`))]);
  for (const frame of frames) {
    const at = name => frame.slice(7 * joints.indexOf(name), 7 * joints.indexOf(name) + 3);
    const axes = name => {
      const [x, y, z, w] = frame.slice(7 * joints.indexOf(name) + 3, 7 * joints.indexOf(name) + 7);
      return {x: [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)], y: [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
        back: [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)]};
    };
    const along = (a, from, to) => a.reduce((sum, v, i) => sum + v * (at(to)[i] - at(from)[i]), 0);
    for (const [k, name] of joints.entries()) {
      if (!/phalanx|thumb-metacarpal/.test(name)) continue;
      const next = joints[k + 1], length = Math.hypot(...at(next).map((v, i) => v - at(name)[i]));
      assert.ok(along(axes(name).back, name, next) < -.99 * length, `${name}: -z along the bone`);
    }
    const wrist = axes('wrist');
    assert.ok(along(wrist.x, 'index-finger-phalanx-proximal', 'pinky-finger-phalanx-proximal') > .04, 'a right hand');
    assert.ok(along(wrist.back, 'wrist', 'middle-finger-phalanx-proximal') < -.08, '-z to the fingers');
    assert.ok(along(wrist.y, 'index-finger-phalanx-proximal', 'index-finger-tip') < .001, 'fingers bend to the palm');
  }
}
