// node figures.mjs DATA.json OUT FORMAT...: every chart of a report as a file for print (svg, pdf). bundle_script.mjs
// puts the specs into CHARTS.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import * as vega from 'vega';
import * as vega_lite from 'vega-lite';
import './charts.js';
import './labels.js';
import {use_font} from './font.mjs';

const [data_file, out, ...formats] = process.argv.slice(2);
const data = JSON.parse(fs.readFileSync(data_file, 'utf8'));
const {register, spec, rows, words, take_class, all_rows, speed_families} = zwang_charts;
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

// What stands in one file: the chart, its file name, its title, and the choices made.
const figures = () => [
  ...distinct('work-precision', 'family').map(family =>
    ['work-precision', `work-precision-${file_name(family)}`, `Speed against accuracy: ${family}`, {family}]),
  ['families', 'work-precision', 'Speed against accuracy by family', {}],
  ...['', ...data.families].map(group => ['profile', group ? `profile-${file_name(group)}` : 'profile',
    `Performance profile at an achieved error of 10⁻⁶: ${group || 'all families'}`, {group}]),
  ['data-profile', 'data-profile', 'Data profile at an achieved error of 10⁻⁶', {}],
  ...distinct('convergence', 'problem').flatMap((trace, i) => ['iteration', 'time'].map(axis =>
    [`convergence-${axis}`, `convergence-${axis}${i ? '-' + file_name(trace) : ''}`, `Convergence: ${trace}`, {trace}])),
  ...distinct('scaling', 'family').map(sweep => ['scaling', `scaling-${file_name(sweep)}`, `Scaling: ${sweep}`, {sweep}]),
  ...speed_families(data).map(size_family => ['speed-ratios', `speed-ratios-${file_name(size_family)}`, `Time over that of dual_active_set: ${size_family}`, {size_family}]),
  ['speed-exponents', 'speed-exponents', 'Exponents of the time over the size', {}],
  ['sweep', 'break-points', 'Stability families, benign to hard', {}],
  ['range-gap', 'range-gap', 'Error against the range gap', {}],
  ['stages', 'stages', 'Where the time of dual_active_set goes', {}],
];

const logger = vega.logger(vega.Error);
async function draw({shown, name: of}, [chart, plain_name, plain_title, choices]) {
  const name = of ? `${plain_name}-${file_name(of)}` : plain_name, title = of ? `${plain_title}; ${of}` : plain_title;
  const state = {on: new Set(shown), listed: new Set(data.solvers.map(s => s.name)), group: '', level: 1e-6, measure: 'z_error', problem: '', ...choices};
  const drawn = rows[chart](data, state);
  if (drawn.length === 0) return;
  const template = structuredClone(CHARTS[chart]);
  const labels = labelled(chart, drawn, {width: template.width, height: template.height});
  const options = {font, title: {text: title, subtitle: data.circumstances},
                   words: {FAMILIES: data.families, COLUMNS: chart === 'families' ? 3 : 2, SWEEP_WIDTH: 230, FACET_WIDTH: 212, LIGHT: true, ...words[chart]?.(data, state), ...labels.words}};
  const compiled = vega_lite.compile(spec(template, labels.rows, data.solvers, options), {logger}).spec;
  const view = new vega.View(vega.parse(compiled), {renderer: 'none', logger});
  const svg = `${out}/${name}.svg`;
  fs.writeFileSync(svg, lean(await view.toSVG()));
  view.finalize();
  if (formats.includes('pdf'))
    execFileSync('rsvg-convert', ['--dpi-x', '96', '--dpi-y', '96', '-f', 'pdf', '-o', `${out}/${name}.pdf`, svg]);
  if (!formats.includes('svg')) fs.unlinkSync(svg);
}

for (const k of data.classes.keys()) {
  const part = take_class(data, k);
  for (const figure of figures()) await draw(part, figure);
}
