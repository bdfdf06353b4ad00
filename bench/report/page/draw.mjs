// node draw.mjs FINDINGS.json OUT: its charts (experiments/questions/questions.py) as OUT/NAME.svg.
import './charts.js';

import fs from 'node:fs';
import * as vega from 'vega';
import * as vega_lite from 'vega-lite';

import {use_font} from './font.mjs';

const [file, out] = process.argv.slice(2);
const found = JSON.parse(fs.readFileSync(file, 'utf8'));
const font = 'Liberation Sans';
use_font(vega, font);
const {config, palette, superscript} = zwang_charts;
// "0.05", "200", "2·10⁻⁶".
vega.expressionFunction('tick_label', value => {
  const [part, power] = value.toExponential().split('e');
  return Math.abs(power) < 4 ? value.toLocaleString('en', {maximumFractionDigits: 6}) : `${part === '1' ? '' : `${part}·`}10${superscript(Number(power))}`;
});
const logger = vega.logger(vega.Error);

// Charts with a logarithmic axis have no place for zero.
const drawn = chart => chart.points.filter(p => !(chart.log_x && p.x <= 0) && !(chart.log_y && p.y <= 0));

// Of a logarithmic axis: powers of ten, at most 8; 1, 2 and 5 of each where they are few.
function ticks(values) {
  const [low, high] = [Math.min(...values), Math.max(...values)].map(Math.log10);
  const step = Math.ceil((high - low) / 8), parts = high - low < 2.5 ? [1, 2, 5] : [1];
  const powers = Array.from({length: Math.ceil((high - low) / step) + 2}, (_, k) => (Math.floor(low / step) + k) * step);
  return powers.flatMap(power => parts.map(part => Number(`${part}e${power}`)));
}

function panel(chart, series) {
  const axis_of = name => {
    if (!chart[`log_${name}`]) return {scale: {zero: false, nice: false, padding: 2}};
    const values = ticks([...drawn(chart).map(p => p[name]), ...name === 'y' ? chart.levels.map(level => level.y) : []]);
    return {scale: {type: 'log', nice: false, padding: 10}, axis: {values, labelExpr: 'tick_label(datum.value)'}};
  };
  const [x, y] = ['x', 'y'].map(name => ({field: name, type: 'quantitative', title: chart[name], ...axis_of(name)}));
  const color = {
    field: 'series',
    type: 'nominal',
    title: null,
    legend: {symbolOpacity: 1},
    scale: {domain: series, range: series.map((_, i) => palette.light[i % palette.light.length])}
  };
  const marks = {
    lines: [{mark: {type: 'line', strokeWidth: 1.4, clip: true}, encoding: {x, y, color}}],
    points: [
      {mark: {type: 'line', strokeWidth: 1, opacity: 0.5}, encoding: {x, y, color}},
      {mark: {type: 'point', filled: true, size: 60, opacity: 1}, encoding: {x, y, color}}
    ],
    shares: [{
      mark: {type: 'area', interpolate: 'step-after'},
      encoding: {x: {...x, scale: {nice: false}}, y: {...y, stack: 'normalize', scale: {}, axis: {format: '%'}}, color}
    }],
  };
  const levels = chart.levels.length === 0 ? [] : [
    {data: {values: chart.levels}, mark: {type: 'rule', strokeDash: [6, 3], color: '#57606a'}, encoding: {y: {...y}}}, {
      data: {values: chart.levels},
      mark: {type: 'text', align: 'right', dy: -5, color: '#57606a'},
      encoding: {x: {value: {expr: 'width'}}, y: {...y}, text: {field: 'text'}}
    }
  ];
  return {data: {values: drawn(chart)}, layer: [...marks[chart.kind], ...levels]};
}

// One chart, or the panels of a figure, two in a row.
function figure(charts) {
  const [first] = charts;
  const series = [...new Set(charts.flatMap(chart => chart.points.map(p => p.series)))];  // one colour in all panels
  const body = charts.length === 1 ? {...panel(first, series), width: 640, height: 320} : {
    concat: charts.map(chart => ({...panel(chart, series), width: 300, height: 170})),
    columns: 2,
    spacing: 24,
  };
  return {
    $schema: 'https://vega.github.io/schema/vega-lite/v6.json',
    title: {text: first.title, subtitle: [found.command, found.circumstances]},
    ...body,
    config: config('light', font),
  };
}

const file_of = chart => chart.figure || chart.name;
for (const name of new Set(found.charts.map(file_of))) {
  const charts = found.charts.filter(chart => file_of(chart) === name);
  const view = new vega.View(vega.parse(vega_lite.compile(figure(charts), {logger}).spec), {renderer: 'none', logger});
  fs.writeFileSync(`${out}/${name}.svg`, await view.toSVG());
  view.finalize();
}
