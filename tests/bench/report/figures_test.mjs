// node figures_test.mjs WRITE_PAGES: figures and tables for print, of a small synthetic run.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import '../../../bench/report/page/charts.js';
import '../../../bench/report/page/labels.js';

const here = new URL('.', import.meta.url).pathname;
const dir = fs.mkdtempSync(`${os.tmpdir()}/zwang-figures-`);
try {
  execFileSync('node', [`${here}make_results.mjs`, dir, 'one']);
  const files = execFileSync(process.argv[2], [dir, 'figures'], {encoding: 'utf8'}).trim().split('\n');
  for (const name of ['figures/work-precision.svg', 'figures/work-precision.pdf', 'figures/profile.svg', 'tables/accuracy.tex', 'tables/accuracy.csv'])
    assert.ok(files.includes(`${dir}/${name}`), `${name} among ${files}`);
  const svg = fs.readFileSync(`${dir}/figures/work-precision-hand.svg`, 'utf8');
  assert.match(svg, /cafebabe0000/, 'a figure names its commit');
  assert.match(svg, /achieved error/, 'axes have titles');
  assert.match(svg, /dual_active_set/, 'the chart names the solver');
  assert.equal(fs.readFileSync(`${dir}/figures/profile.pdf`).subarray(0, 5).toString(), '%PDF-');
  assert.match(fs.readFileSync(`${dir}/tables/accuracy.csv`, 'utf8'), /^hand,dual_active_set,\d/m);
  assert.ok(!fs.existsSync(`${dir}/figures/data.json`), 'no helper file stays behind');
} finally {
  fs.rmSync(dir, {recursive: true, force: true});
}

// Names of points that coincide stand apart, inside the box, and off what is drawn there.
const box = {left: 0, right: 400, top: 0, bottom: 200}, wall = Array.from({length: 40}, (_, i) => ({x: 110 + i, y: 100}));
const labels = zwang_labels.place(Array.from({length: 8}, (_, i) => ({x: 100, y: 100, text: `solver_${i}`})), wall, box);
assert.equal(labels.length, 8);
for (const {rect} of labels) {
  assert.ok(rect.left >= 0 && rect.right <= 400 && rect.top >= 0 && rect.bottom <= 200);
  assert.ok(!wall.some(p => p.x > rect.left && p.x < rect.right && p.y > rect.top && p.y < rect.bottom), 'no name covers the wall');
  assert.equal(labels.filter(other => other.rect.left < rect.right && rect.left < other.rect.right && other.rect.top < rect.bottom && rect.top < other.rect.bottom).length, 1);
}

// Names in a column: in the order of their ends, a line of text apart, inside the box, and undisturbed where there is room.
const column = zwang_labels.stack([5, 5, 5, 5, 100, 199, 199].map((y, i) => ({x: 100, y, text: `${i}`})), box);
for (let i = 1; i < column.length; ++i) assert.ok(column[i].at_y - column[i - 1].at_y >= 12.99);
assert.ok(column[0].at_y >= 6 && column.at(-1).at_y <= 194);
assert.equal(column[4].at_y, 100);
