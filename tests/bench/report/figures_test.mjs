// node figures_test.mjs PROGRAM: figures and tables for print, of a small synthetic run.
import assert from 'node:assert/strict';
import {execFileSync, spawnSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import '../../../bench/report/page/charts.js';
import '../../../bench/report/page/labels.js';
import {to_csv, to_tex} from '../../../bench/report/page/table_files.mjs';
import {written} from './written.mjs';

// Of Vega's ticks on a short axis some are named, each by another name.
{
  const named = {};
  zwang_charts.register({expressionFunction: (name, call) => { named[name] = call; }});
  const steps = (from, step, to) => Array.from({length: Math.round((to - from) / step) + 1}, (_, k) => from + k * step);
  const labels = (name, ticks, domain) => ticks.map(tick => named[name](tick, domain)).filter(label => label !== '');
  assert.deepEqual(labels('time_label', steps(1.1e-5, 5e-7, 1.9e-5), [1.1e-5, 1.9e-5]), ['12 µs', '14 µs', '16 µs', '18 µs']);
  assert.deepEqual(labels('time_label', steps(2.2e-5, 2e-6, 4.8e-5), [2.1e-5, 4.9e-5]), ['30 µs', '40 µs']);
  assert.deepEqual(labels('time_label', [8e-6, 9e-6, 1e-5, 2e-5, 3e-5], [8e-6, 3e-5]), ['9 µs', '10 µs', '20 µs', '30 µs']);
  assert.deepEqual(labels('time_label', [1e-5, 2e-5, 5e-5, 1e-4, 2e-4], [1e-5, 2e-4]), ['10 µs', '20 µs', '50 µs', '100 µs', '200 µs']);
  assert.deepEqual(labels('size_label', steps(4, 0.05, 5), [4, 5]), ['4', '5']);
  assert.deepEqual(labels('time_label', [3.3e-5], [3.3e-5, 3.3e-5]), ['33 µs']);
}

const here = new URL('.', import.meta.url).pathname;
const dir = fs.mkdtempSync(`${os.tmpdir()}/zwang-figures-`);
try {
  execFileSync('node', [`${here}make_results.mjs`, dir, 'one']);
  const figures = (run, ...words) => written(process.argv[2], run, '--figures', 'svg,pdf', ...words), files = figures(dir);
  for (const name of ['figures/work-precision.svg', 'figures/work-precision.pdf', 'figures/profile.svg', 'tables/accuracy.tex', 'tables/accuracy.csv'])
    assert.ok(files.includes(`${dir}/${name}`), `${name} among ${files}`);
  const svg = fs.readFileSync(`${dir}/figures/work-precision-hand.svg`, 'utf8');
  assert.doesNotMatch(svg, /cafebabe0000|synthetic/, 'circumstances belong into the caption');
  assert.match(fs.readFileSync(`${dir}/figures/work-precision-hand.txt`, 'utf8'), /^CPU time of a solve against the relative error .*: hand\. .*commit cafebabe0000/);
  assert.match(svg, /relative error \|z − z\*\|/, 'axes have titles');
  assert.match(svg, /↙ better/);
  assert.match(svg, /dual_active_set/, 'the chart names the solver');
  assert.equal(fs.readFileSync(`${dir}/figures/profile.pdf`).subarray(0, 5).toString(), '%PDF-');
  assert.match(fs.readFileSync(`${dir}/tables/accuracy.csv`, 'utf8'), /^hand,dual_active_set,\d/m);
  assert.match(fs.readFileSync(`${dir}/tables/accuracy.tex`, 'utf8'), /\\begin\{table\*?\}[^]*\\caption\{Time to[^]*\\label\{tab:zwang-accuracy\}[^]*\\toprule[^]*\\midrule[^]*\\bottomrule/);
  assert.ok(!fs.existsSync(`${dir}/figures/data.json`), 'no helper file stays behind');

  // Six lines at most, 8 pt at the width asked for, and only what was chosen.
  const full = `${dir}/full`, draw = (chart, solver, family, width) =>
    figures(full, '--chart', chart, ...(solver === '-' ? [] : ['--solvers', solver]), '--families', family, '--width', `${width}in`);
  execFileSync('node', [`${here}make_results.mjs`, full, 'full']);
  const width_of = text => Number(/ width="([\d.]+)"/.exec(text)[1]);
  for (const [chart, file, solver, width] of [['work-precision', 'work-precision-hand', 'nnls', 3.4], ['profile', 'profile-hand', 'pgs', 2], ['families', 'work-precision', 'nnls', 3.4], ['work-precision', 'work-precision-hand', '-', 3.4]]) {
    fs.rmSync(`${full}/figures`, {recursive: true, force: true});
    draw(chart, solver, 'hand', width);
    const text = fs.readFileSync(`${full}/figures/${file}.svg`, 'utf8'), named = [...text.matchAll(/>(nnls_paper|nnls|cholesky|dual_active_set|ipopt|pgs|apgd|mine|nlopt:[a-z=]+|bullet_\w+)(?:, [^<]*)?</g)].map(match => match[1]);
    assert.deepEqual(fs.readdirSync(`${full}/figures`).sort(), [`${file}.pdf`, `${file}.svg`, `${file}.txt`]);
    if (solver !== '-') {
      assert.deepEqual([...new Set(named)], [solver]);
      if (chart !== 'families') assert.ok(Math.abs(width_of(text) - 96 * width) < 2, `${width_of(text)} px`);
    } else {
      assert.ok(new Set(named).size > 3 && new Set(named).size <= 6, named.join(' '));
    }
    for (const [, size] of text.matchAll(/font-size="([\d.]+)px"/g)) assert.ok(Math.abs(size - 8 * 96 / 72) < 0.01, `${size} px`);
  }
  fs.rmSync(`${full}/figures`, {recursive: true, force: true});
  draw('families', '-', 'hand', 3.4);
  const marks = [...fs.readFileSync(`${full}/figures/work-precision.svg`, 'utf8').matchAll(/role-legend-symbol[^>]*><path [^>]*d="([^"]*)"/g)].map(match => match[1]);
  assert.ok(marks.length > 3 && new Set(marks).size === marks.length, `small multiples: a shape a solver, ${marks}`);
  assert.ok(fs.readFileSync(`${full}/tables/accuracy.csv`, 'utf8').trim().split('\n').slice(1).every(line => line.startsWith('hand,')), 'tables of what was chosen');
  assert.throws(() => draw('wrok-precision', 'nnls', 'hand', 3.4), /no chart 'wrok-precision'; did you mean 'work-precision'/);
  assert.throws(() => draw('profile', 'nnsl', 'hand', 3.4), /no solver 'nnsl'; did you mean 'nnls'/);

  // A figure and all tables stand in an article of one column and of two, and nothing is wider than its text.
  const has_latex = spawnSync('pdflatex', ['--version']).status === 0;
  if (!has_latex) console.log('pdflatex is not installed: no LaTeX file was compiled');
  const kinds = new Set();
  for (const run of ['full', 'laws', 'speed'].filter(() => has_latex)) {
    const at = `${dir}/${run}-tex`;
    execFileSync('node', [`${here}make_results.mjs`, at, run]);
    figures(at, '--chart', 'data-profile', '--width', '3in');
    const tables = fs.readdirSync(`${at}/tables`).filter(name => name.endsWith('.tex')), input = names => names.map(name => `\\input{tables/${name}}`).join('\n');
    const environment = name => /\\begin\{(table\*?|longtable)\}/.exec(fs.readFileSync(`${at}/tables/${name}`, 'utf8'))[1], is_long = name => environment(name) === 'longtable';
    tables.forEach(name => kinds.add(environment(name)));
    const figures = fs.readdirSync(`${at}/figures`).filter(name => name.endsWith('.pdf')).map(name => `\\begin{figure}\\includegraphics{figures/${name}}\\caption{${name}}\\end{figure}`);
    for (const style of ['10pt', '10pt,twocolumn', '12pt,a4paper,twocolumn']) {
      fs.writeFileSync(`${at}/all.tex`, `\\documentclass[${style}]{article}\\usepackage{array,booktabs,longtable,graphicx}\\begin{document}Text.\n${figures.join('\n')}
${input(tables.filter(name => !is_long(name)))}\n\\onecolumn\n${input(tables.filter(is_long))}\n\\end{document}\n`);
      for (const pass of [1, 2])
        assert.equal(spawnSync('pdflatex', ['-interaction=nonstopmode', '-halt-on-error', 'all.tex'], {cwd: at}).status, 0, `${run}, ${style}, pass ${pass}`);
      assert.deepEqual(fs.readFileSync(`${at}/all.log`, 'latin1').match(/^(Overfull \\hbox|LaTeX Warning: Float too large).*/gm) ?? [], [], `${run}, ${style}`);
    }
  }
  assert.deepEqual([...kinds].sort(), has_latex ? ['longtable', 'table*'] : []);
} finally {
  fs.rmSync(dir, {recursive: true, force: true});
}

// Names of points that coincide stand apart, inside the box, and off what is drawn there.
const box = {left: 0, right: 400, top: 0, bottom: 200}, wall = Array.from({length: 40}, (_, i) => ({x: 110 + i, y: 100}));
const points = Array.from({length: 8}, (_, i) => ({x: 100, y: 100, solver: 'solver', text: `solver_${i}`, along: []}));
const labels = zwang_labels.place(points, [...wall, ...points], box);
assert.equal(labels.length, 8);
for (const {rect} of labels) {
  assert.ok(rect.left >= 0 && rect.right <= 400 && rect.top >= 0 && rect.bottom <= 200);
  assert.ok(!wall.some(p => p.x > rect.left && p.x < rect.right && p.y > rect.top && p.y < rect.bottom), 'no name covers the wall');
  assert.equal(labels.filter(other => other.rect.left < rect.right && rect.left < other.rect.right && other.rect.top < rect.bottom && rect.top < other.rect.bottom).length, 1);
}

// In charts of 3 to 8 solvers, lines and lone points alike: no name covers a marker, and each
// is nearest to its own solver, or tied to it by a leader.
let seed = 1;
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
for (let chart = 0; chart < 60; ++chart) {
  const rows = [];
  for (let k = 0; k < 3 + chart % 6; ++k) {
    const x = 10 ** (-16 * random()), time = 10 ** (-5 + 3 * random()), points = random() < 0.5 ? 1 : 6;
    for (let i = 0; i < points; ++i)
      rows.push({solver: `a_solver_${k}`, drawn: 'ok', exact: points === 1, tolerance: 10 ** -i, x: x * 10 ** (-i / 2), time: time * 1.3 ** i});
  }
  const [width, height] = [1040, 440];
  const {rows: drawn, words} = zwang_labels.labelled('work-precision', rows, {width, height});
  const pixel = row => ({
    x: Math.log(row.x / words.X_DOMAIN[0]) / Math.log(words.X_DOMAIN[1] / words.X_DOMAIN[0]) * width,
    y: height - Math.log(row.time / words.Y_DOMAIN[0]) / Math.log(words.Y_DOMAIN[1] / words.Y_DOMAIN[0]) * height,
  });
  for (const label of drawn.filter(row => row.part === 'label')) {
    const at = pixel(label), near = at.x + label.shift, far = near + Math.sign(label.shift) * 6 * label.text.length;
    const off = p => Math.hypot(Math.max(Math.min(near, far) - p.x, 0, p.x - Math.max(near, far)), Math.max(at.y - 6.5 - p.y, 0, p.y - at.y - 6.5));
    assert.ok(rows.every(row => off(pixel(row)) > 3), `chart ${chart}: ${label.text} covers no marker`);
    const to_line = of => Math.min(...rows.filter(of).flatMap(row => {
      const next = rows[rows.indexOf(row) + 1], [a, b] = [row, next?.solver === row.solver ? next : row].map(pixel);
      return Array.from({length: 41}, (_, k) => off({x: a.x + (b.x - a.x) * k / 40, y: a.y + (b.y - a.y) * k / 40}));
    }));
    const own = to_line(row => row.solver === label.solver), others = to_line(row => row.solver !== label.solver);
    assert.ok(label.far || own <= others, `chart ${chart}: ${label.text} is nearest to its own line (${own} and ${others} px)`);
  }
}

// Names in a column: in the order of their ends, a line of text apart, inside the box, and undisturbed where there is room.
const column = zwang_labels.stack([5, 5, 5, 5, 100, 199, 199].map((y, i) => ({x: 100, y, text: `${i}`})), box);
for (let i = 1; i < column.length; ++i) assert.ok(column[i].at_y - column[i - 1].at_y >= 12.99);
assert.ok(column[0].at_y >= 6 && column.at(-1).at_y <= 194);
assert.equal(column[4].at_y, 100);

// Tables escape what their format reads.
const table = {id: 't', note: 'A note.', columns: [{name: 'a_b', numeric: false}, {name: 'x, y', numeric: true}], rows: [{cells: [{text: '50 %'}, {text: '2.0 us', value: 2e-6}]}]};
assert.equal(to_csv(table), 'a_b,"x, y"\n50 %,2e-06\n');
const qualified = [['1.0 ms (3.0x) on 2 of 5', 1e-3], ['> 2.0 s', 2], ['<= 3e-9', 3e-9], ['3 of 5 (wrong)', 3], ['not reached', NaN], ['7', 7]];
assert.equal(to_csv({columns: [{name: 'x', numeric: true}], rows: qualified.map(([text, value]) => ({cells: [{text, value}]}))}),
             'x,x: note\n0.001,on 2 of 5\n2,>\n3e-09,<=\n3,of 5\nnot reached,\n7,\n');
for (const part of ['a\\_b & x, y \\\\\n', '50 \\% & 2.0 $\\mu$s \\\\\n', '\n\\begin{table}\n']) assert.ok(to_tex(table).includes(part), part);
for (const [value, text] of [[0, '0'], [120, '120'], [1234567890, '1.23456789e+09'], [0.1 + 0.2, '0.3'], [1.5e-300, '1.5e-300'], [-2.5, '-2.5'], [1e9, '1e+09'], [123456789, '123456789'], [1e-5, '1e-05'], [0.0001, '0.0001'], [2 ** -13, '0.000122070312'], [3 * 2 ** -13, '0.000366210938'], [99999999.95, '100000000'], [5e-324, '4.94065646e-324']])
  assert.equal(to_csv({columns: [{name: 'x', numeric: true}], rows: [{cells: [{text: '', value}]}]}), `x\n${text}\n`);
assert.match(to_tex({...table, rows: Array(130000).fill(table.rows[0])}), /\\begin\{longtable\}/, 'of any length');
