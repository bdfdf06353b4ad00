// node league_page_test.mjs PROGRAM [PNG]: the page of two solvers, one of them in two versions, in headless Chromium.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import {is_quiet, open_browser} from './chromium.mjs';

const program = path.resolve(process.argv[2]), png = process.argv[3];
const folder = fs.mkdtempSync(`${os.tmpdir()}/zwang-league-page-`);
const reply = 'Made for games. <b>Not</b> for hands.';
const row = (solver, k, {verified = 'solved', seconds = 1e-3, machine = 'one'} = {}) => JSON.stringify({
  problem: `hand(seed=${k})`, family: 'hand', problem_sha256: String(k).repeat(64), solver, tolerance: 1e-10, claimed: 'solved', verified,
  z_error: 1e-13 * (k + 1), solve_s: seconds, machine,
});
function record(solver, version, packs, url = '') {
  const place = `${folder}/${solver}-${version}`;
  for (const [pack, lines] of Object.entries(packs)) {
    fs.mkdirSync(`${place}/${pack}`, {recursive: true});
    fs.writeFileSync(`${place}/${pack}/results.jsonl`, lines.map(line => line + '\n').join(''));
  }
  fs.writeFileSync(`${place}/entry.json`, JSON.stringify({solver, version, url, reply: solver === 'mine' ? reply : ''}));
  return place;
}
const all = (solver, more = () => ({})) => [0, 1, 2, 3].map(k => row(solver, k, more(k)));
const records = [
  record('mine', '0.10', {guard: all('mine'), more: all('mine', () => ({machine: 'two'}))}, 'https://example.org/mine'),
  record('mine', '0.9', {guard: all('mine', k => (k === 2 ? {verified: 'wrong'} : {}))}),
  record('theirs', '7', {guard: all('theirs', () => ({seconds: 2e-3})), more: all('theirs')}),
];
execFileSync(program, ['league', ...records, '--out', `${folder}/league`]);
const cells = id => `[...document.querySelectorAll('[data-table=${id}] tbody tr')].map(tr => [...tr.cells].map(td => td.textContent))`;

const browser = await open_browser();
try {
  for (const [width, dark] of [[1280, false], [1280, true], [400, false], [400, true]]) {
    const page = await browser.open_page(`${folder}/league/index.html`, {width, dark});
    assert.equal(await page.evaluate(`document.querySelector('#headline').textContent`),
      '3 entries of 2 solvers on 2 packs: guard (4 problems), more (4 problems).');
    assert.deepEqual(await page.evaluate(cells('standings')), [
      ['mine', '0.9', '3 of 4 right, 1 false, error 2·10⁻¹³, 3 ms for 3', '–'],
      ['mine', '0.10', '4 of 4 right, 0 false, error 3·10⁻¹³, 3 ms for 3', '4 of 4 right, 0 false, error 3·10⁻¹³'],
      ['theirs', '7', '4 of 4 right, 0 false, error 3·10⁻¹³, 6 ms for 3', '4 of 4 right, 0 false, error 3·10⁻¹³'],
    ].map(line => line.map(text => text.replace(/\b([23])·10/g, '$1.0·10'))));
    assert.deepEqual((await page.evaluate(cells('history'))).map(line => line.slice(0, 5)),
      [['mine', 'guard', '0.9', '3', '1'], ['mine', 'guard', '0.10', '4 (+1)', '0 (−1)']]);
    assert.deepEqual(await page.evaluate(`[...document.querySelectorAll('#entries p')].map(p => p.textContent)`), [reply, reply, 'No reply.']);
    assert.deepEqual(await page.evaluate(`[...document.querySelectorAll('#entries a')].map(a => a.href)`), ['https://example.org/mine']);
    assert.equal(await page.evaluate('document.documentElement.dataset.theme'), dark ? 'dark' : 'light');
    assert.equal(await page.evaluate('document.documentElement.scrollWidth'), width, 'the page does not scroll sideways');
    await is_quiet(page);
    if (png) await page.screenshot(png.replace('.png', `-${width}-${dark ? 'dark' : 'light'}.png`));
    await page.close();
  }
} finally {
  await browser.close();
  fs.rmSync(folder, {recursive: true, force: true});
}
console.log('the page of a league says what its records hold');
