// node replay_test.mjs WRITE_REPLAY: the replay page of a fabricated run, driven in headless Chromium.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import {is_quiet, open_browser} from '../bench/report/chromium.mjs';

const folder = fs.mkdtempSync(`${os.tmpdir()}/zwang-replay-`);
const write = (name, frames) => execFileSync(process.argv[2], [`${folder}/${name}`, String(frames)], {encoding: 'utf8'}).trim();
// The page begins after it is drawn, and plays: paused here, for software draws slowly.
const open = async (file, options = {}, then = 'zwang_replay.play(false)') => {
  const page = await browser.open_page(file, options);
  for (let tries = 0; tries < 100 && !(await page.evaluate('!!globalThis.zwang_replay')); ++tries) await page.evaluate(wait(100));
  if (then) await page.evaluate(then);
  return page;
};
const wait = milliseconds => `new Promise(done => setTimeout(done, ${milliseconds}))`;
const text = selector => `document.querySelector('${selector}').textContent`;
const frame = 'zwang_replay.frame';
// Share of the view's pixels that something is drawn on, and of those that are blue: the god hand's.
const ink = `(() => {
  zwang_replay.world.draw();
  const view = document.getElementById('view'), copy = document.createElement('canvas');
  copy.width = view.width / 4; copy.height = view.height / 4;
  const pen = copy.getContext('2d');
  pen.drawImage(view, 0, 0, copy.width, copy.height);
  const pixels = pen.getImageData(0, 0, copy.width, copy.height).data;
  let solid = 0, blue = 0;
  for (let i = 0; i < pixels.length; i += 4) { solid += pixels[i + 3] > 200; blue += pixels[i + 3] > 200 && pixels[i + 2] > pixels[i] + 60; }
  return {solid: 4 * solid / pixels.length, blue: 4 * blue / pixels.length};
})()`;

const browser = await open_browser();
try {
  await replays_a_run();
  await opens_where_something_happens();
  await remembers_its_state();
  await fits_a_phone_in_the_dark();
  await thins_a_long_run();
} finally {
  await browser.close();
  fs.rmSync(folder, {recursive: true, force: true});
}

async function replays_a_run() {
  const file = write('run', 300);
  assert.ok(fs.statSync(file).size < 5e6, `${fs.statSync(file).size} bytes`);
  const page = await open(file, {width: 1280, height: 800});
  assert.equal(await page.evaluate('document.title'), 'zwang: dip in ground');
  await page.evaluate('zwang_replay.show(0)');
  const drawn = await page.evaluate(ink);
  assert.ok(drawn.solid > .3 && drawn.blue > .005, `objects and hand are drawn: ${JSON.stringify(drawn)}`);
  await page.key('h');
  assert.ok((await page.evaluate(ink)).blue < drawn.blue / 3, 'the hand can be hidden');
  await page.key('h');
  const chart = await page.evaluate(`(() => { const c = document.getElementById('chart'), p = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let n = 0; for (let i = 3; i < p.length; i += 4) n += p[i] > 0; return 4 * n / p.length; })()`);
  assert.ok(chart > .5, `the timeline is drawn: ${chart}`);

  // One frame by button; keys.
  await page.evaluate(`document.getElementById('forth').click()`);
  assert.equal(await page.evaluate(frame), 1);
  for (const [key, modifiers, expected] of [['ArrowRight', 8, 11], ['ArrowLeft', 0, 10], ['End', 0, 299], ['ArrowRight', 0, 299], ['Home', 0, 0]]) {
    await page.key(key, modifiers);
    assert.equal(await page.evaluate(frame), expected, `${key} ${modifiers}`);
  }

  // Scrub with the slider; then on the timeline with the mouse.
  await page.evaluate(`(() => { const scrub = document.getElementById('scrub'); scrub.value = 100; scrub.dispatchEvent(new Event('input')); })()`);
  assert.equal(await page.evaluate(frame), 100);
  assert.match(await page.evaluate(text('#clock')), /^1\.010 sframe 100 of 300$/);
  assert.match(await page.evaluate(text('#numbers')), /40 → 5/);
  const box = await page.evaluate(`(({left, top, width}) => ({left, top, width}))(document.getElementById('timeline').getBoundingClientRect())`);
  const x = box.left + 46 + .5 * (box.width - 46);
  await page.mouse('mouseMoved', x, box.top + 60);
  assert.match(await page.evaluate(text('#tip')), /^frame 1\d\d, 1\.\d+ s[^]*collision/);
  for (const type of ['mousePressed', 'mouseReleased']) await page.mouse(type, x, box.top + 60, {button: 'left', buttons: 1, clickCount: 1});
  assert.ok(Math.abs(await page.evaluate(frame) - 150) <= 1);

  // Next wrong: held, stuck, penetration, wrong answer, and round again; each says what it is.
  await page.evaluate('zwang_replay.show(0)');
  for (const [expected, badge] of [[60, /held/], [90, /stuck/], [120, /penetration/], [150, /wrong answer/], [60, /held/]]) {
    await (expected === 90 ? page.key('n') : page.evaluate(`document.getElementById('next').click()`));
    assert.equal(await page.evaluate(frame), expected);
    assert.match(await page.evaluate(text('#badges')), badge);
  }
  assert.equal(await page.evaluate(text('#next')), 'next wrong (4)');

  // Play slowly and pause: software rendering must not outrun the click.
  await page.evaluate(`(zwang_replay.show(0), zwang_replay.set_speed(.25))`);
  await page.evaluate(`document.getElementById('play').click()`);
  assert.equal(await page.evaluate(`document.getElementById('play').getAttribute('aria-label')`), 'Pause');
  await page.evaluate(wait(1500));
  await page.evaluate(`document.getElementById('play').click()`);
  const reached = await page.evaluate(frame);
  assert.ok(reached > 0 && reached < 299, `played to ${reached}`);
  await page.evaluate(wait(300));
  assert.equal(await page.evaluate(frame), reached, 'paused');
  await page.evaluate(`(zwang_replay.show(295), zwang_replay.set_speed(4), zwang_replay.play(true))`);
  await page.evaluate(wait(1500));
  assert.deepEqual(await page.evaluate('[zwang_replay.frame, zwang_replay.playing]'), [299, false], 'stops at the end');

  // Another camera draws another picture; so does turning by mouse, after which no preset is pressed.
  const view = 'zwang_replay.world.view().join()';
  const iso = await page.evaluate(view);
  await page.key('4');
  assert.notEqual(await page.evaluate(view), iso);
  assert.equal(await page.evaluate(`document.querySelector('#cameras [aria-pressed=true]').value`), 'top');
  const before = await page.evaluate(view);
  await page.mouse('mousePressed', 640, 450, {button: 'left', buttons: 1, clickCount: 1});
  await page.mouse('mouseMoved', 700, 420, {button: 'left', buttons: 1});
  await page.mouse('mouseReleased', 700, 420, {button: 'left', clickCount: 1});
  assert.notEqual(await page.evaluate(view), before);
  assert.equal(await page.evaluate(`document.querySelectorAll('#cameras [aria-pressed=true]').length`), 0);

  // The policy in the page stops a request before it leaves.
  assert.equal(await page.evaluate(`fetch('http://127.0.0.1:9/').then(() => 'sent', () => 'stopped')`), 'stopped');
  page.complaints.length = 0;  // the browser reports the stopped request itself
  page.requests.splice(1);
  await is_quiet(page, 'zwang_replay');
  await page.close();
}

// It plays from before the first push on; of a link, it rests at the frame with that number.
async function opens_where_something_happens() {
  const page = await open(`${folder}/run/replay.html`, {width: 400, height: 400}, '');
  const pushed = await page.evaluate('zwang_replay.pushed');
  assert.ok(pushed > 0, `frame ${pushed}`);
  assert.equal(await page.evaluate('zwang_replay.playing'), true);
  const early = await page.evaluate(frame);
  assert.ok(early >= pushed - 41, `plays from frame ${early}, pushes in ${pushed}`);
  await page.evaluate(wait(1200));
  assert.ok(await page.evaluate(frame) > early, 'plays on');
  assert.equal(await page.evaluate(`document.getElementById('loading')`), null);
  await page.close();
  assert.match(fs.readFileSync(`${folder}/run/replay.html`, 'utf8'), /<p id="loading" role="status">Loading/);
}

async function remembers_its_state() {
  const page = await open(`${folder}/run/replay.html`, {hash: 'frame=77&cam=side&theme=dark&not=ghost,xray&speed=0.5'});
  assert.equal(await page.evaluate(frame), 77);
  assert.equal(await page.evaluate('document.documentElement.dataset.theme'), 'dark');
  assert.deepEqual(await page.evaluate('[zwang_replay.world.layers.ghost, zwang_replay.world.layers.xray]'), [false, true]);
  await page.key('ArrowRight');
  await page.key('t');
  await page.evaluate(wait(400));
  assert.equal(await page.evaluate('location.hash'), '#frame=78&cam=side&theme=light&not=ghost,xray&speed=0.5');
  await is_quiet(page, 'zwang_replay');
  await page.close();
}

async function fits_a_phone_in_the_dark() {
  const page = await open(`${folder}/run/replay.html`, {width: 390, height: 800, dark: true});
  assert.equal(await page.evaluate('document.documentElement.dataset.theme'), 'dark');
  const outside = await page.evaluate(`[...document.querySelectorAll('button, select, #clock, .panel')].filter(x => { const b = x.getBoundingClientRect(); return x.checkVisibility() && b.width > 0 && (b.right > 391 || b.left < -1 || b.bottom > 801); }).map(x => x.id || x.textContent)`);
  assert.deepEqual(outside, [], 'nothing sticks out');
  assert.ok((await page.evaluate(ink)).blue > .003);
  await is_quiet(page, 'zwang_replay');
  await page.close();
}

// Of 7,000 frames 3,000 are shown, and the few that matter are among them.
async function thins_a_long_run() {
  const page = await open(write('long', 7000), {width: 1280, height: 800});
  assert.equal(await page.evaluate('zwang_replay.frames'), 3000);
  await page.evaluate('zwang_replay.show(0)');
  assert.match(await page.evaluate(text('#lines')), /3,000 of 7,000 frames are shown/);
  const numbers = [];
  for (let k = 0; k < 4; ++k) numbers.push(await page.evaluate(`(zwang_replay.next_wrong(), document.querySelector('#clock small').textContent)`));
  assert.deepEqual(numbers, [60, 90, 120, 150].map(n => `frame ${n} of 7,000`));
  await page.evaluate(`(zwang_replay.show(2900), ${wait(400)})`);
  const shown = Number((await page.evaluate(text('#clock small'))).match(/^frame ([\d,]+)/)[1].replace(',', ''));
  assert.ok(shown > 6000, `${shown}`);
  assert.match(await page.evaluate('location.hash'), new RegExp(`^#frame=${shown}&`), 'the address has the frame of the run');
  await is_quiet(page, 'zwang_replay');
  await page.close();
}
