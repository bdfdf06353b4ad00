// node figures.mjs DATA.json OUT TABLES: charts of a report as files for print (svg, pdf), and the caption of each as .txt;
// its tables as .csv and .tex.
// bundle_script.mjs puts the specs into CHARTS.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import * as vega from 'vega';
import * as vega_lite from 'vega-lite';
import './charts.js';
import './labels.js';
import {to_csv, to_tex} from './table_files.mjs';
import {use_font} from './font.mjs';

const [data_file, out, tables_out] = process.argv.slice(2);
const {page: data, print: {formats, charts, solvers, families, width}} = JSON.parse(fs.readFileSync(data_file, 'utf8'));
const {register, spec, rows, words, take_class, all_rows, speed_families, relative_error} = zwang_charts;
const {labelled} = zwang_labels;
const font = 'Liberation Sans';
use_font(vega, font);
register(vega);

const distinct = (name, field) => [...new Set(all_rows(data, name).map(row => row[field]))];
const file_name = text => text.replace(/[^A-Za-z0-9]+/g, '-').replace(/^-|-$/g, '').toLowerCase();

// A figure is named by its caption: without the labels for screen readers, and on hundredths of a point, a file is a
// fourth as large.
const lean = svg => svg.replace(/<[^>]*>/g, tag => tag
  .replace(/ (aria-[a-z]+|role|pointer-events)="[^"]*"/g, '')
  .replace(/^<path class="(background|foreground)".* d="(M0,0h0v0h0Z)?".*/, '')
  .replace(/-?\d+\.\d{3,}/g, number => String(Number(Number(number).toFixed(2)))));

// Of the families asked for alone, without what is summed over all.
if (families.length)
  for (const part of data.classes) {
    part.families = part.families.filter(family => families.includes(family));
    part.tables.speed?.rows.splice(0, Infinity, ...part.tables.speed.rows.filter(row => families.includes(row.group)));
    for (const chart of Object.values(part.charts)) {
      const at = chart.fields.indexOf('family');
      if (at >= 0) chart.rows = chart.rows.filter(row => families.includes(row[at]));
    }
  }

const median_of = 'A line joins the medians over the problems of a family, from loose to tight tolerance; bars are quartiles of repeated timings.';
// What stands in one file: the chart, its file name, its caption, and the choices made.
const figures = () => [
  ...distinct('work-precision', 'family').map(family =>
    ['work-precision', `work-precision-${file_name(family)}`, `CPU time of a solve against the ${relative_error}: ${family}. ${median_of}`, {family}]),
  ['families', 'work-precision', `CPU time of a solve against the ${relative_error}, by family. ${median_of}`, {}],
  ...[...families.length ? [] : [''], ...data.families].map(group => ['profile', group ? `profile-${file_name(group)}` : 'profile',
    `Performance profile at a relative error of 10⁻⁶: share of the problems that a solver reads, solved within a multiple of the fastest time; ${group || 'all families'}.`, {group}]),
  ['data-profile', 'data-profile', 'Share of the problems that a solver reads, solved to a relative error of 10⁻⁶ within a CPU time; all families.', {}],
  ...distinct('convergence', 'problem').flatMap((trace, i) => ['iteration', 'time'].map(axis =>
    [`convergence-${axis}`, `convergence-${axis}${i ? '-' + file_name(trace) : ''}`, `Relative error of the iterates over the ${axis === 'time' ? 'CPU time of a solve stopped there' : 'iteration'}: ${trace}.`, {trace}])),
  ...distinct('scaling', 'family').map(sweep => ['scaling', `scaling-${file_name(sweep)}`, `CPU time to a relative error of 10⁻⁶ over the size: ${sweep}. Thick: power laws fitted to the upper half.`, {sweep}]),
  ...speed_families(data).map(size_family => ['speed-ratios', `speed-ratios-${file_name(size_family)}`, `Time over that of dual_active_set: ${size_family}.`, {size_family}]),
  ['speed-exponents', 'speed-exponents', 'Exponents p of the time over the size, with two standard errors.', {}],
  ['sweep', 'break-points', 'Errors on the stability families, benign at the left and hard at the right. !: false claim, ×: fails and says so, ?: undecided, t: time limit, c: crashed, ✓: infeasible and proven.', {}],
  ['range-gap', 'range-gap', 'Relative error over the distance of c from the range of J.', {}],
  ['stages', 'stages', 'Where the time of dual_active_set goes.', {}],
].filter(([chart]) => !charts.length || charts.includes(chart));

// A figure's type is 8 pt at every width. The plot is what its axes leave of the width; names that find no place in it
// stand in its key.
const point = 96 / 72, eight = 8 * point, lines = 6;
const is_many = {families: 165, sweep: 255};  // width of a panel and what is beside it
function compiled(chart, rows_drawn, state, best, plot) {
  const template = structuredClone(CHARTS[chart]);
  template.width = plot;
  if (width && template.height > 0) template.height = Math.round(Math.min(template.height, 0.72 * plot));
  const room = {width: plot, height: template.height, best, most: lines};
  const drawn = [...new Set(rows_drawn.filter(row => row.drawn !== 'recorded').map(row => row.solver))];
  let labels = labelled(chart, rows_drawn, room);
  if (!drawn.every(name => labels.rows.some(row => row.part === 'label' && row.solver === name)))
    labels = {rows: rows_drawn, words: labelled(chart, rows_drawn, {...room, in_key: drawn}).words};
  const columns = Math.max(1, Math.floor((plot + 60) / (is_many[chart] ?? plot)));
  const options = {font, size: eight, plot: {width: plot, height: template.height ?? 200}, words: {
    FAMILIES: data.families, COLUMNS: columns, SWEEP_WIDTH: Math.min(230, plot - 60), FACET_WIDTH: (plot + 10) / columns - 14, LIGHT: true,
    ...words[chart]?.(data, state), ...labels.words,
  }};
  const among = data.solvers.map(s => ({...s, shown: best.includes(s.name)}));
  return vega_lite.compile(spec(template, labels.rows, among, options), {logger}).spec;
}

const logger = vega.logger(vega.Error);
async function draw({shown, name: of}, [chart, plain_name, words_of, choices]) {
  const name = of ? `${plain_name}-${file_name(of)}` : plain_name;
  const best = solvers.length ? solvers : shown.slice(0, lines);
  const state = {on: new Set(best), listed: new Set(solvers.length ? solvers : data.solvers.map(s => s.name)), group: '', level: 1e-6, measure: 'z_error', problem: '', ...choices};
  const drawn = rows[chart](data, state);
  if (drawn.length === 0) return;
  const svg = `${out}/${name}.svg`, asked = 96 * width;
  let plot = width ? asked - 62 : CHARTS[chart].width ?? 640, image;
  for (let off = 1, pass = 0; Math.abs(off) >= 1 && pass < 5; ++pass) {
    const view = new vega.View(vega.parse(compiled(chart, drawn, state, best, plot)), {renderer: 'none', logger});
    image = await view.toSVG();
    view.finalize();
    off = width ? asked - Number(/ width="([\d.]+)"/.exec(image)[1]) : 0;
    plot = Math.max(plot + off, 60);
  }
  fs.writeFileSync(svg, lean(image));
  fs.writeFileSync(`${out}/${name}.txt`, `${words_of}${of ? ` Problems: ${of}.` : ''} ${data.circumstances}.\n`);
  if (formats.includes('pdf'))
    execFileSync('rsvg-convert', ['--dpi-x', '96', '--dpi-y', '96', '-f', 'pdf', '-o', `${out}/${name}.pdf`, svg]);
  if (!formats.includes('svg')) fs.unlinkSync(svg);
}

// Progress on stderr: a line that is redrawn on a terminal, else every tenth part.
const planned = data.classes.reduce((sum, _, k) => (take_class(data, k), sum + figures().length), 0);
let done = 0;
function progress(name) {
  ++done;
  if (process.stderr.isTTY) process.stderr.write(`\r${done} of ${planned} charts   ${name}\x1b[K${done === planned ? '\r\x1b[K' : ''}`);
  else if (Math.floor(10 * done / planned) > Math.floor(10 * (done - 1) / planned)) process.stderr.write(`${Math.floor(10 * done / planned)}0 %\n`);
}
const left_out = (chosen, name) => chosen.length > 0 && name && !chosen.includes(name);
function write_tables(tables, ending) {
  for (const [name, {note, columns, rows: all}] of Object.entries(tables)) {
    const chosen = all.filter(row => !left_out(solvers, row.solver) && !left_out(families, row.group));
    if (chosen.length === 0) continue;
    const table = {id: name + ending, note, columns, rows: chosen};
    fs.writeFileSync(`${tables_out}/${table.id}.csv`, to_csv(table));
    fs.writeFileSync(`${tables_out}/${table.id}.tex`, to_tex(table));
  }
}
write_tables(data.common ?? data.tables, '');
for (const part of data.classes) write_tables(part.tables, part.name && `-${part.name.replaceAll(' ', '-').toLowerCase()}`);
for (const k of data.classes.keys()) {
  const part = take_class(data, k);
  for (const figure of figures()) {
    await draw(part, figure);
    progress(figure[1]);
  }
}
