// node draw.mjs FINDINGS.json OUT: its charts (experiments/questions/question.h) as OUT/NAME.svg.
import './charts.js';

import fs from 'node:fs';
import * as vega from 'vega';
import * as vega_lite from 'vega-lite';

import {use_font} from './font.mjs';

const [file, out] = process.argv.slice(2);
const found = JSON.parse(fs.readFileSync(file, 'utf8'));
const font = 'Liberation Sans';
use_font(vega, font);
const {config, palette} = zwang_charts;
const logger = vega.logger(vega.Error);

// Charts with a logarithmic axis have no place for zero.
const drawn = chart => chart.points.filter(p => !(chart.log_x && p.x <= 0) && !(chart.log_y && p.y <= 0));

function panel(chart, series) {
  const scale = log => log ? {type: 'log', nice: false, padding: 10} : {zero: false, nice: false, padding: 2};
  const format = log => log ? {labelExpr: 'format(datum.value, \'~g\')', tickCount: 6} : {};
  const x = {field: 'x', type: 'quantitative', title: chart.x, scale: scale(chart.log_x), axis: format(chart.log_x)};
  const y = {field: 'y', type: 'quantitative', title: chart.y, scale: scale(chart.log_y), axis: format(chart.log_y)};
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
