// node collision_page_test.mjs PROGRAM [PNG]: the page of a synthetic collision run, driven in headless Chromium.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import {is_quiet, open_browser} from './chromium.mjs';
import {written} from './written.mjs';

const [program, png] = process.argv.slice(2);
const folder = fs.mkdtempSync(`${os.tmpdir()}/zwang-collision-page-`);
const engines = ['zwang', 'fcl', 'bullet'];
const each = value => Object.fromEntries(engines.map((engine, k) => [engine, value(k)]));

const pairs = [1e3, 1e4, 1e5].flatMap(triangles => ['sliding', 'pressing', 'passing'].map(motion => ({
  triangles, gap: 2e-4, motion, placements: 100, smallest_gap: 6e-5, true_hits: 40,
  times: each(k => 3e-6 * 10 ** k * Math.log10(triangles)), p95: each(k => 1e-5 * 10 ** k), stops: each(k => 1e-4 * (k + 1)), hits: each(k => 40 + k),
})));
const run = (scene, speed, penetrations) => ({
  scene, parts: 'procedural', speed, spin: 0, triangles: 1e6, pieces: 20, bytes_per_triangle: 97, frames: 980, median: 1.5e-4, touching_median: 3.9e-4, p95: 8e-4,
  p99: 1e-3, worst: 2e-3, touches: 1e-4, manifold: 2e-5, toc: 3e-5, raw: 412, kept: 27.5, most_raw: 1900, truncations: 4, held: 0, completed: 31, overlaps: 0,
  whole_median: 2.5e-4, gap: 6.1e-5, body_frames: 15680, touching: 9000, audited: 16100, penetrations, seconds: 3,
});
const results = {
  suite: 'collision', command: './zwang bench --suite collision', headline: ['A finger sliding: 4.1 us <b>', 'Audit: 1 penetrations'],
  conditions: {version: '0.1.0', commit: 'abcdef0', compiler: 'GNU', flags: '-O3', build: 'Release', CPU: 'synthetic', cores: 2, libraries: {FCL: '0.7.0'}},
  pairs, frames: [run('1M triangles, 20 parts', 0.5, 0), run('sheet without thickness', 5, 0)],
  audits: [run('1M triangles, 20 parts', 0.5, 0), run('sheet without thickness', 5, 1)],
};
const report_of = json => {
  fs.writeFileSync(`${folder}/collision.json`, JSON.stringify(json));
  return written(program, folder)[0];
};
const settled = 'new Promise(done => setTimeout(done, 500))';
const rows = id => `[...document.querySelectorAll('#${id} tbody tr')].map(tr => [...tr.cells].map(td => td.textContent))`;
const marks = id => `document.querySelectorAll('#${id} svg .mark-symbol path, #${id} svg .mark-rect path, #${id} svg .mark-rule line').length`;

const browser = await open_browser();
try {
  await shows_a_run();
  await shows_a_run_that_was_stopped();
  await fits_a_phone();
} finally {
  await browser.close();
  fs.rmSync(folder, {recursive: true, force: true});
}

async function shows_a_run() {
  const page = await browser.open_page(report_of(results));
  await page.evaluate(settled);
  assert.equal(await page.evaluate('document.title'), 'zwang: collision suite');
  assert.equal(await page.evaluate(`document.querySelector('main .chart').id`), 'frames', 'the page opens with frame times');
  assert.deepEqual(await page.evaluate(`[...document.querySelectorAll('#headline p')].map(p => p.textContent)`), results.headline);
  assert.ok(await page.evaluate(marks('pairs')) >= engines.length * pairs.length, 'a point for every engine and pair');
  assert.ok(await page.evaluate(marks('frames')) >= 3 * results.frames.length, 'line, bar and tick for every run');
  const words = await page.evaluate(`document.querySelector('#pairs svg').textContent`);
  for (const engine of engines) assert.ok(words.includes(engine), `${engine} is named in the chart`);

  const pair_rows = await page.evaluate(rows('pair-table'));
  assert.equal(pair_rows.length, pairs.length);
  assert.deepEqual(pair_rows[0].slice(0, 7), ['1,000', 'sliding at 0.2 mm', '9.0', '90.0', '900.0', '10×', '100×']);
  const frame_rows = await page.evaluate(rows('frame-table'));
  assert.deepEqual(frame_rows[0].slice(3, 10), ['1,000,000', '97', '0.15', '0.39', '0.80', '1.00', '2.00']);
  const audit_rows = await page.evaluate(rows('audit-table'));
  assert.deepEqual(audit_rows[1].slice(0, 8), ['sheet without thickness', '5', '', '15,680', '9,000', '16,100', '1', '61.0 µm']);
  assert.deepEqual(await page.evaluate(`[...document.querySelectorAll('#audit-table td.good, #audit-table td.bad')].map(td => td.className)`), ['number good', 'number bad']);
  assert.ok((await page.evaluate(rows('conditions'))).some(([what, value]) => what === 'commit' && value === 'abcdef0'));
  await is_quiet(page);
  assert.equal(await page.evaluate(`fetch('http://127.0.0.1:9/').then(() => 'sent', () => 'stopped')`), 'stopped');
  page.complaints.length = 0;  // the browser reports the stopped request itself
  page.requests.splice(1);
  if (png) await page.screenshot(png);
  await page.close();
}

async function shows_a_run_that_was_stopped() {
  const {headline, ...stopped} = {...results, frames: [], audits: []};
  const page = await browser.open_page(report_of(stopped));
  await page.evaluate(settled);
  assert.match(await page.evaluate(`document.querySelector('#headline').textContent`), /stopped before its end/);
  assert.equal((await page.evaluate(rows('pair-table'))).length, pairs.length);
  assert.equal((await page.evaluate(rows('frame-table'))).length, 0);
  assert.match(await page.evaluate(`document.querySelector('#frames').textContent`), /stopped before/);
  await is_quiet(page);
  await page.close();
}

async function fits_a_phone() {
  const page = await browser.open_page(report_of(results), {width: 390, height: 800});
  await page.evaluate(settled);
  assert.ok(await page.evaluate('document.documentElement.scrollWidth') <= 390, 'nothing sticks out at the side');
  await is_quiet(page);
  await page.close();
}
