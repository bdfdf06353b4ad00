// node large_page_test.mjs PROGRAM: the page of a run of more than 20,000 runs, which loads single ones from scripts
// beside it. node large_page_test.mjs --measure RUN: the same of a run whose report is written; prints size and time.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import {open_browser} from './chromium.mjs';
import {written} from './written.mjs';

const measured = process.argv[2] === '--measure';
const folder = fs.mkdtempSync(`${os.tmpdir()}/zwang-large-`);
const run = measured ? process.argv[3] : `${folder}/run`;
if (!measured) {
  execFileSync('node', [`${new URL('.', import.meta.url).pathname}make_results.mjs`, run, 'large']);
  written(process.argv[2], run);
}
const browser = await open_browser();
try {
  const bytes = fs.statSync(`${run}/report.html`).size;
  assert.ok(bytes < 20e6, `${bytes} bytes`);
  const page = await browser.open_page(`${run}/report.html`);
  const first_chart = `new Promise(done => {
    const look = () => document.querySelector('main canvas') ? done(performance.now() / 1000) : requestAnimationFrame(look);
    look();
  })`;
  const seconds = await page.evaluate(first_chart), cpu = await page.cpu_seconds();
  console.log(`page ${(bytes / 1e6).toFixed(1)} MB, ${seconds.toFixed(2)} s to the first chart (${cpu.toFixed(2)} s of CPU time), ${fs.readdirSync(`${run}/runs`).length} scripts of single runs`);
  if (measured) assert.ok(cpu < 3, `${cpu} s of CPU time`);
  assert.equal(page.requests.filter(url => url.includes('/runs/')).length, 0, 'no script is loaded before it is asked for');
  await shows_single_runs(page);
  await page.close();
} finally {
  await browser.close();
  fs.rmSync(folder, {recursive: true, force: true});
}

async function shows_single_runs(page) {
  const choose = (which, at) => page.evaluate(`(() => {
    const choice = document.querySelectorAll('#single select')[${which}];
    choice.selectedIndex = ${at} < 0 ? choice.options.length - 1 : ${at};
    choice.onchange();
  })()`);
  const rows = () => page.evaluate(`new Promise(done => {
    const look = () => {
      const rows = [...document.querySelectorAll('#single tbody tr')].map(tr => [...tr.cells].map(cell => cell.textContent));
      rows.length || document.querySelector('#single .table').textContent.includes('not beside') ? done(rows) : setTimeout(look, 10);
    };
    look();
  })`);
  const scripts = () => page.requests.filter(url => url.includes('/runs/')).map(url => url.replace(/.*\//, ''));
  await choose(0, -1);
  const last = await rows();
  assert.ok(last.length > 0 && last.every(row => row.length === 8 && /^\.\/zwang solve \S+\.h5 --solver \S+ --tolerance/.test(row[7])), last[0]);
  assert.equal(scripts().length, 1);
  await choose(1, 0);
  await rows();
  await choose(1, 0);
  assert.equal(scripts().length, new Set(scripts()).size, 'each script is loaded once');
  assert.deepEqual(page.complaints, []);
  if (measured) return;
  fs.rmSync(`${run}/runs/0.js`);
  const bare = await browser.open_page(`${run}/report.html`);
  await bare.evaluate(`(() => { const [family] = document.querySelectorAll('#single select'); family.selectedIndex = 0; family.onchange(); })()`);
  await bare.evaluate(`new Promise(done => setTimeout(done, 300))`);
  assert.match(await bare.evaluate(`document.querySelector('#single .table').textContent`), /runs\/0\.js is not beside this page/);
  await bare.close();
}
