// node page_test.mjs PROGRAM: the report of synthetic runs, driven in headless Chromium.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import {is_quiet, open_browser} from './chromium.mjs';
import {misplaced_names} from './names.mjs';
import {written} from './written.mjs';

const program = process.argv[2];
const here = new URL('.', import.meta.url).pathname;
const folder = fs.mkdtempSync(`${os.tmpdir()}/zwang-page-`);
const run_of = kind => {
  execFileSync('node', [`${here}make_results.mjs`, `${folder}/${kind}`, kind]);
  return `${folder}/${kind}`;
};
const report_of = kind => written(program, run_of(kind))[0];

const charts = ['work-precision', 'families', 'profile', 'data-profile', 'convergence-iteration', 'convergence-time', 'scaling', 'sweep', 'range-gap'];
const settled = 'new Promise(done => setTimeout(done, 300))';
const ink = name => `(() => {
  const canvas = document.querySelector('[data-chart="${name}"] canvas');
  if (!canvas) return 0;
  const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  let inked = 0;
  for (let i = 3; i < pixels.length; i += 4) inked += pixels[i] > 20;
  return inked / (pixels.length / 4);
})()`;
const solvers_in = name => `[...new Set(zwang_page.views['${name}'].data('rows').map(row => row.solver))]`;

const browser = await open_browser();
try {
  await browses_a_full_run();
  await opens_with_a_chart_above_the_fold();
  await names_the_lines_of_a_sample();
  await fits_a_phone_in_the_dark();
  for (const kind of ['empty', 'one', 'undecided', 'torn']) await explains_what_is_missing(kind);
  await sets_two_runs_side_by_side();
  await draws_eight_of_sixteen();
  await opens_with_the_picture_of_its_suite();
  await never_mixes_classes();
} finally {
  await browser.close();
  fs.rmSync(folder, {recursive: true, force: true});
}

async function browses_a_full_run() {
  const page = await browser.open_page(report_of('full'));
  await page.evaluate('zwang_page.draw_all()');
  assert.equal(await page.evaluate('document.title'), 'zwang: synthetic suite');
  assert.equal((await page.evaluate(solvers_in('work-precision'))).filter(name => !name.startsWith('recorded:')).length, 8, 'the best of the class');
  await page.evaluate(`document.querySelector('.chip:not([data-solver])').click()`);
  await page.evaluate(settled);
  for (const name of charts) assert.ok(await page.evaluate(ink(name)) > 0.005, `${name} has ink`);
  assert.equal(await page.evaluate(`document.querySelector('main [data-chart]').dataset.chart`), 'work-precision', 'the page opens with speed against accuracy');
  assert.equal(await page.evaluate(`document.querySelector('main table').closest('[data-table]').dataset.table`), 'claim-counts', 'the first table counts false claims');
  const counts = await page.evaluate(`[...document.querySelectorAll('[data-table=claim-counts] tbody tr')].map(tr => [tr.cells[0].textContent, Number(tr.cells[1].textContent)])`);
  assert.ok(counts.length >= 2 && counts.length <= 11, 'a row for each solver with a false claim');
  assert.ok(counts.every(([, n], i) => i === 0 || n <= counts[i - 1][1]), 'the most false claims first');
  assert.deepEqual(await page.evaluate(`[...document.querySelectorAll('#claims details')].map(x => x.open)`), [false, false], 'the long tables are folded');
  const first_row = await page.evaluate(`document.querySelector('[data-table=claims] tbody tr').textContent`);
  assert.match(first_row, /solved|infeasible/);

  // An exact solver is one point, and every solver has its name in the chart, inside the plot.
  const drawn = await page.evaluate(`zwang_page.views['work-precision'].data('rows')`);
  assert.equal(drawn.filter(row => row.solver === 'dual_active_set' && row.drawn === 'ok').length, 1);
  assert.ok(drawn.filter(row => row.solver === 'pgs' && row.drawn === 'ok').length > 2);
  const time = `document.querySelector('select[data-state=time]')`;
  const choose_time = value => page.evaluate(`(${time}.value = '${value}', ${time}.onchange(), ${settled})`);
  await choose_time('own');
  const share = row => row.time / drawn.find(of => of.solver === row.solver && of.problem === row.problem && of.drawn === row.drawn && of.part === row.part && of.tolerance === row.tolerance).time;
  const own = (await page.evaluate(`zwang_page.views['work-precision'].data('rows')`)).filter(row => row.drawn === 'ok');
  for (const row of own) assert.ok(Math.abs(share(row) - (row.solver.match(/ipopt|nlopt|bullet/) ? 0.7 : 0.9)) < 0.05, `${row.solver} without its preparation`);
  await choose_time('whole');
  const labels = drawn.filter(row => row.part === 'label');
  assert.deepEqual(labels.map(row => row.solver).sort(), [...new Set(drawn.filter(row => row.drawn !== 'recorded').map(row => row.solver))].sort());
  assert.match(labels.find(row => row.solver === 'dual_active_set').text, /^dual_active_set, [\d.]+ [nµm]?s$/);
  for (const label of labels) assert.ok(label.x > 2e-20 && label.x < 60, `${label.solver} is named inside the plot`);
  assert.match(await page.evaluate(`document.querySelector('#claims tr.command code').textContent`), /^\.\/zwang solve \S+\.h5 --solver \S+ --tolerance 1e-\d+$/);

  // What came with the problems is a line across, whoever is chosen, and no solver.
  const recorded = drawn.filter(row => row.solver === 'recorded:mujoco');
  assert.equal(recorded.length, 1);
  assert.equal(recorded[0].x, 0.021);
  assert.equal(await page.evaluate(`document.querySelectorAll('[data-table=recorded] tbody tr').length`), 1);
  assert.ok(!(await page.evaluate(`[...document.querySelectorAll('.chip')].map(chip => chip.textContent)`)).includes('recorded:mujoco'));
  assert.match(await page.evaluate(`document.getElementById('headline').textContent`), /2 recorded answers judged beside the runs, 0 right/);
  assert.equal(await page.evaluate(`document.getElementById('sequences')`), null, 'no section without sequences');

  await page.evaluate(`zwang_page.choose(new Set(['nnls', 'pgs']))`);
  assert.equal(await page.evaluate('location.hash'), '#solvers=nnls,pgs');
  await page.evaluate(`zwang_page.choose(new Set([...document.querySelectorAll('.chip[data-solver]')].map(chip => chip.dataset.solver)))`);
  const chip = `document.querySelector('.chip[data-solver=nnls]')`;
  assert.ok((await page.evaluate(solvers_in('work-precision'))).includes('nnls'));
  await page.evaluate(`(${chip}.click(), ${settled})`);
  for (const name of ['work-precision', 'families', 'profile', 'scaling', 'sweep'])
    assert.ok(!(await page.evaluate(solvers_in(name))).includes('nnls'), `${name} hides nnls`);
  assert.ok(!(await page.evaluate(`[...document.querySelectorAll('#accuracy td.solver')].map(td => td.textContent)`)).includes('nnls'));
  await page.evaluate(`(${chip}.click(), ${settled})`);
  assert.ok((await page.evaluate(solvers_in('work-precision'))).includes('nnls'));
  await page.evaluate(`zwang_page.choose(new Set())`);
  assert.match(await page.evaluate(`document.querySelector('[data-chart=profile]').innerText`), /No solver is chosen/);
  await page.evaluate(`zwang_page.choose(new Set(['nnls', 'pgs']))`);
  assert.ok(await page.evaluate(ink('profile')) > 0.005, 'drawn again after none');

  // A point found through the scales: tooltip, replay command on click, zoom only with Alt.
  const find = `(() => {
    const view = zwang_page.views['work-precision'], box = document.querySelector('[data-chart=work-precision] canvas').getBoundingClientRect();
    const row = view.data('rows').find(row => row.solver === 'pgs' && row.drawn === 'ok');
    return {x: box.left + view.origin()[0] + view.scale('x')(row.x), y: box.top + view.origin()[1] + view.scale('y')(row.time), replay: row.replay};
  })()`;
  await page.evaluate(`(document.querySelector('[data-chart=work-precision]').scrollIntoView({block: 'center'}), ${settled})`);
  const point = await page.evaluate(find);
  await page.mouse('mouseMoved', point.x + 2, point.y + 1);
  await page.mouse('mouseMoved', point.x, point.y);
  await page.evaluate(settled);
  const tip = await page.evaluate(`document.querySelector('#vg-tooltip-element').innerText`);
  for (const part of ['pgs', 'tolerance asked', 'error achieved', 'claimed', 'verified', 'replay']) assert.ok(tip.includes(part), `tooltip has ${part}: ${tip}`);
  for (const type of ['mousePressed', 'mouseReleased']) await page.mouse(type, point.x, point.y, {button: 'left', clickCount: 1});
  await page.evaluate(settled);
  assert.equal(await page.evaluate(`document.querySelector('[data-chart=work-precision] .tools code').textContent`), point.replay);
  const domain = `zwang_page.views['work-precision'].scale('x').domain()`;
  const before = await page.evaluate(domain);
  await page.mouse('mouseWheel', point.x, point.y, {deltaX: 0, deltaY: 60});
  await page.evaluate(settled);
  assert.deepEqual(await page.evaluate(domain), before, 'the wheel alone scrolls the page');
  const again = await page.evaluate(find);
  await page.mouse('mouseWheel', again.x, again.y, {deltaX: 0, deltaY: -200, modifiers: 1});
  await page.evaluate(settled);
  assert.notDeepEqual(await page.evaluate(domain), before, 'Alt and the wheel zoom');

  // The policy in the page stops a request before it leaves.
  assert.equal(await page.evaluate(`fetch('http://127.0.0.1:9/').then(() => 'sent', () => 'stopped')`), 'stopped');
  page.complaints.length = 0;  // the browser reports the stopped request itself
  page.requests.splice(1);
  await is_quiet(page, 'zwang_page');
  await page.close();
}

async function opens_with_a_chart_above_the_fold() {
  for (const [width, height, dark] of [[1280, 1000, false], [1280, 1000, true], [400, 800, false], [400, 800, true]]) {
    const page = await browser.open_page(`${folder}/full/report.html`, {width, height, dark});
    await page.evaluate('zwang_page.draw_all()');
    const box = await page.evaluate(`(({top, bottom}) => ({top, bottom}))(document.querySelector('main [data-chart] canvas').getBoundingClientRect())`);
    assert.ok(width === 400 ? box.top < height / 2 : box.bottom <= height, `the first chart is in sight at ${width} px: ${JSON.stringify(box)}`);
    assert.equal(await page.evaluate(`document.querySelectorAll('#headline > p').length`), 2, 'two sentences, the others are folded');
    assert.deepEqual(await misplaced_names(page), [], `at ${width} px`);
    const names = await page.evaluate(`zwang_page.views['work-precision'].data('rows').filter(row => row.part === 'label').map(row => row.solver)`);
    assert.ok(width === 400 ? names.length <= 5 && names.length > 2 : names.length === 8, `${names}`);
    // The key says what each glyph that is drawn means; bars are the quartiles of repeated timings.
    const drawn = new Set(await page.evaluate(`zwang_page.views['work-precision'].data('rows').map(row => row.drawn)`));
    const key = await page.evaluate(`zwang_labels.key(zwang_page.views['work-precision'].data('rows'), ${width})`);
    assert.deepEqual(key.map(row => row.kind).sort(), [...drawn, 'bar'].map(kind => kind === 'recorded' ? 'line' : kind).filter(kind => kind !== 'label').sort());
    await page.close();
  }
}

// The same of the sample report's data, in today's page.
async function names_the_lines_of_a_sample() {
  const slot = /(<script type="application\/json" id="data">).*?(<\/script>)/s;
  const data = fs.readFileSync(`${here}../../../docs/sample-report.html`, 'utf8').match(slot)[0];
  fs.writeFileSync(`${folder}/sample.html`, fs.readFileSync(`${folder}/full/report.html`, 'utf8').replace(slot, () => data));
  for (const [width, dark] of [[1280, false], [1280, true], [400, false], [400, true]]) {
    const page = await browser.open_page(`${folder}/sample.html`, {width, height: 900, dark});
    await page.evaluate('zwang_page.draw_all()');
    assert.deepEqual(await misplaced_names(page), [], `at ${width} px`);
    await page.close();
  }
}

async function fits_a_phone_in_the_dark() {
  const page = await browser.open_page(`${folder}/full/report.html`, {width: 390, height: 800, dark: true});
  await page.evaluate('zwang_page.draw_all()');
  assert.equal(await page.evaluate('document.documentElement.dataset.theme'), 'dark');
  assert.ok(await page.evaluate('document.documentElement.scrollWidth') <= 390, 'nothing sticks out at the side');
  for (const name of charts) assert.ok(await page.evaluate(ink(name)) > 0.005, `${name} has ink in the dark`);
  await page.evaluate(`zwang_page.set_theme('light')`);
  assert.ok(await page.evaluate(ink('profile')) > 0.005, 'drawn again in the light');
  await is_quiet(page, 'zwang_page');
  await page.close();
}

async function explains_what_is_missing(kind) {
  const page = await browser.open_page(report_of(kind));
  await page.evaluate('zwang_page.draw_all()');
  const text = await page.evaluate('document.body.innerText');
  const bare = await page.evaluate(`[...document.querySelectorAll('[data-chart], [data-table]')].filter(x => x.textContent.trim() === '' && !x.querySelector('canvas')).map(x => x.outerHTML)`);
  assert.deepEqual(bare, [], `${kind}: each empty chart and table says why`);
  if (kind === 'empty') assert.match(text, /holds no results/);
  if (kind === 'one') assert.match(text, /none of the stability families/);
  if (kind === 'undecided') assert.match(await page.evaluate(`JSON.stringify(zwang_labels.key(zwang_page.views['work-precision'].data('rows'), 1000))`), /not proven: upper bound/);
  if (kind === 'torn') assert.match(text, /last line of results.jsonl is torn/);
  await is_quiet(page, 'zwang_page');
  await page.close();
}

async function sets_two_runs_side_by_side() {
  const file = written(program, `${folder}/full`, run_of('later'), '--out', `${folder}/comparison.html`)[0];
  const page = await browser.open_page(file);
  await page.evaluate('zwang_page.draw_all()');
  const chips = await page.evaluate(`[...document.querySelectorAll('.chip[data-solver]')].map(chip => chip.dataset.solver)`);
  for (const name of ['nnls @A', 'nnls @B', 'mine']) assert.ok(chips.includes(name), `${name} among ${chips}`);
  assert.match(await page.evaluate(`document.querySelector('#comparison').innerText`), /Only in run B: mine/);
  assert.equal(await page.evaluate(`document.querySelectorAll('#comparison tbody tr').length`), 11);
  assert.ok(await page.evaluate(ink('work-precision')) > 0.005);
  await is_quiet(page, 'zwang_page');
  await page.close();
}

async function draws_eight_of_sixteen() {
  const page = await browser.open_page(report_of('crowd'));
  await page.evaluate('zwang_page.draw_all()');
  assert.equal((await page.evaluate(solvers_in('profile'))).length, 8);
  assert.match(await page.evaluate(`document.getElementById('left-out').textContent`), /^Charts show the best 8 of 16 solvers; .* Tables show all\.$/);
  assert.equal(await page.evaluate(`document.querySelectorAll('[data-table=solvers] tbody tr').length`), 16);
  const marks = await page.evaluate(`[...document.querySelectorAll('.chip[aria-pressed=true] path')].map(path => path.getAttribute('d'))`);
  assert.equal(new Set(marks).size, 8, 'each has a shape of its own, for grey print');
  await is_quiet(page, 'zwang_page');
  await page.close();
  const chosen = await browser.open_page(`${folder}/crowd/report.html`, {hash: 'solvers=newton,mujoco_newton,unheard_of'});
  await chosen.evaluate('zwang_page.draw_all()');
  assert.deepEqual((await chosen.evaluate(solvers_in('profile'))).sort(), ['mujoco_newton', 'newton']);
  await is_quiet(chosen, 'zwang_page');
  await chosen.close();
}

async function opens_with_the_picture_of_its_suite() {
  for (const [kind, first] of [['atlas', ['sweep']], ['speed', ['speed-ratios', 'speed-exponents']]]) {
    const page = await browser.open_page(report_of(kind));
    await page.evaluate('zwang_page.draw_all()');
    assert.deepEqual(await page.evaluate(`[...document.querySelectorAll('main [data-chart]')].slice(0, ${first.length}).map(x => x.dataset.chart)`), first);
    for (const name of first) assert.ok(await page.evaluate(ink(name)) > 0.005, `${name} has ink`);
    const tables = await page.evaluate(`[...document.querySelectorAll('main [data-table]')].map(x => x.dataset.table)`);
    if (kind === 'atlas') assert.equal(await page.evaluate(`document.querySelectorAll('[data-table=stability] tbody tr').length`), 5);
    assert.ok(kind === 'speed' ? tables[0] === 'claim-counts' : tables.indexOf('claim-counts') > tables.indexOf('break-points'), `${tables}`);
    await is_quiet(page, 'zwang_page');
    await page.close();
  }
}

async function never_mixes_classes() {
  const classes = {QP: 11, 'convex cone': 3, Coulomb: 2};
  const page = await browser.open_page(report_of('laws'));
  await page.evaluate('zwang_page.draw_all()');
  const picker = `document.querySelector('select[data-state=problem_class]')`;
  assert.deepEqual(await page.evaluate(`[...${picker}.options].map(option => option.textContent)`), Object.keys(classes));
  for (const [k, [name, readers]] of Object.entries(classes).entries()) {
    await page.evaluate(`(${picker}.value = '${k}', ${picker}.onchange(), ${settled})`);
    assert.match(await page.evaluate(`document.getElementById('ranking').textContent`), new RegExp(`^${name}: on \\d+ hand`));
    assert.equal(await page.evaluate(`document.querySelectorAll('.chip[data-solver]').length`), readers);
    assert.equal((await page.evaluate(solvers_in('profile'))).length, Math.min(readers, 8));
    const families = await page.evaluate(`[...new Set(zwang_page.views['families'].data('rows').map(row => row.family))]`);
    assert.deepEqual(families.sort(), name === 'QP' ? ['hand', 'hand (pyramid)', 'tower', 'tower (pyramid)'] : name === 'Coulomb' ? ['hand', 'tower'] : ['hand (convex)', 'tower (convex)']);
    // Whoever reads all problems of the class can reach 100 % of them; nobody is measured against those of another class.
    const reads = await page.evaluate(`[...new Set(zwang_page.views['profile'].data('rows').map(row => row.reads).filter(Boolean))]`);
    assert.ok(reads.every(n => n <= (name === 'QP' ? 24 : 12)), `${name}: ${reads}`);
    for (const chart of ['work-precision', 'families', 'profile', 'data-profile', 'scaling']) assert.ok(await page.evaluate(ink(chart)) > 0.005, `${chart} of ${name}`);
    const solved = await page.evaluate(`[...document.querySelectorAll('[data-table=means] tbody td:nth-child(2)')].map(td => Number(td.textContent.split(' of ')[1]))`);
    assert.ok(solved.length === readers && solved.every(n => n <= (name === 'QP' ? 24 : 12)));
    assert.ok(await page.evaluate(`document.querySelectorAll('[data-table=claim-counts] tbody tr').length`) > 2, 'false claims are of all classes');
  }
  assert.equal(await page.evaluate('location.hash'), '#class=Coulomb');
  await page.evaluate(`zwang_page.choose(new Set(['cholesky']))`);
  assert.equal(await page.evaluate('location.hash'), '#class=Coulomb&solvers=cholesky');
  await is_quiet(page, 'zwang_page');
  await page.close();
  const linked = await browser.open_page(`${folder}/laws/report.html`, {hash: 'class=convex%20cone&solvers=apgd,pgs'});
  await linked.evaluate('zwang_page.draw_all()');
  assert.deepEqual((await linked.evaluate(solvers_in('profile'))).sort(), ['apgd', 'pgs']);
  await is_quiet(linked, 'zwang_page');
  await linked.close();
  const one_class = await browser.open_page(`${folder}/full/report.html`);
  assert.equal(await one_class.evaluate(`${picker}.closest('label').hidden`), true, 'one class needs no picker');
  await one_class.close();
}
