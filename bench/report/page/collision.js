// The collision page: three tables and two charts from collision.json.
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const ms = s => (1e3 * s).toFixed(s < 1e-4 ? 3 : 2), us = s => (1e6 * s).toFixed(1);
  const count = n => Math.round(n).toLocaleString('en');
  const length = m => m >= 1e-3 ? `${(1e3 * m).toPrecision(3)} mm` : `${(1e6 * m).toPrecision(3)} µm`;
  const name = s => `${s.scene}, ${s.speed} m/s`;

  function table(id, columns, rows, mark = () => '') {
    const t = document.createElement('table'), head = t.createTHead().insertRow(), body = t.createTBody();
    for (const [title, , numeric] of columns) {
      const th = document.createElement('th');
      th.textContent = title;
      if (numeric) th.className = 'number';
      head.append(th);
    }
    for (const row of rows) {
      const tr = body.insertRow();
      for (const [title, cell, numeric] of columns) {
        const td = tr.insertCell();
        td.textContent = cell(row);
        td.className = `${numeric ? 'number' : ''} ${mark(title, row)}`.trim();
      }
    }
    const scroll = document.createElement('div');
    scroll.className = 'scroll';
    scroll.append(t);
    document.getElementById(id).append(scroll);
  }

  function draw(id, rows, spec) {
    if (rows.length === 0) {
      document.getElementById(id).textContent = 'The run was stopped before the first of these.';
      return;
    }
    vegaEmbed(`#${id}`, {
      $schema: 'https://vega.github.io/schema/vega-lite/v6.json', width: 'container', background: null,
      data: {values: rows}, config: {view: {stroke: null}, axis: {labelFontSize: 12, titleFontSize: 12, labelLimit: 320}}, ...spec,
    }, {mode: 'vega-lite', actions: false, renderer: 'svg', ast: true, expr: vega_interpreter});
  }

  for (const line of data.headline ?? ['The run was stopped before its end.']) {
    const p = document.createElement('p');
    p.textContent = line;
    document.getElementById('headline').append(p);
  }

  const engines = ['zwang', 'fcl', 'bullet'];
  const motions = {sliding: 'sliding at 0.2 mm', pressing: 'pressing at 0.2 mm', passing: 'passing at 2 mm'};
  const largest = {from: Math.min(...data.pairs.map(p => p.triangles)), to: Math.max(...data.pairs.map(p => p.triangles))};
  // Names at the right ends of the lines, pushed up where two would overlap (by a line of text: a fifth of a decade).
  const names = data.pairs.filter(p => p.triangles === largest.to).flatMap(p => {
    let below = 0;
    return [...engines].sort((a, b) => p.times[a] - p.times[b]).map(engine => {
      below = Math.max(1e6 * p.times[engine], 1.6 * below);
      return {engine, triangles: p.triangles, time: below, motion: motions[p.motion], name: engine};
    });
  });
  const queries = data.pairs.flatMap(p => engines.map(engine => ({engine, triangles: p.triangles, time: 1e6 * p.times[engine], motion: motions[p.motion]})));
  draw('pairs', [...queries, ...names], {
    height: 320, width: 300,
    facet: {column: {field: 'motion', title: null, sort: Object.values(motions), header: {labelFontSize: 13, labelFontWeight: 600}}},
    spec: {
      height: 300, width: 300,
      encoding: {
        x: {field: 'triangles', type: 'quantitative', scale: {type: 'log', domain: [largest.from, 4 * largest.to], nice: false}, title: 'triangles',
            axis: {values: [1e3, 1e4, 1e5, 1e6], format: '~s'}},
        y: {field: 'time', type: 'quantitative', scale: {type: 'log'}, title: 'time of a query (µs)', axis: {values: [1, 10, 100, 1e3, 1e4, 1e5], format: '~s'}},
        color: {field: 'engine', type: 'nominal', scale: {domain: engines, range: ['#4b2bd7', '#019bc2', '#923f67']}, legend: null},
      },
      layer: [
        {transform: [{filter: '!datum.name'}], mark: {type: 'line', tooltip: null}, encoding: {strokeDash: {field: 'engine', type: 'nominal', scale: {domain: engines, range: [[1, 0], [7, 3], [2, 2.5]]}, legend: null}}},
        {transform: [{filter: '!datum.name'}], mark: {type: 'point', size: 60, filled: true, opacity: 1, tooltip: true}, encoding: {shape: {field: 'engine', type: 'nominal', scale: {domain: engines}, legend: null}}},
        {transform: [{filter: 'datum.name'}], mark: {type: 'text', align: 'left', dx: 8, fontSize: 12, tooltip: null},
         encoding: {text: {field: 'name'}, color: {value: '#1b1f24'}}},
      ],
    },
  });
  table('pair-table', [
    ['triangles', p => count(p.triangles), true], ['motion', p => motions[p.motion]],
    ...engines.map(e => [`${e} (µs)`, p => us(p.times[e]), true]),
    ['zwang against fcl', p => `${(p.times.fcl / p.times.zwang).toFixed(0)}×`, true],
    ['against bullet', p => `${(p.times.bullet / p.times.zwang).toFixed(0)}×`, true],
    ['truly stopped', p => p.true_hits, true],
    ...engines.map(e => [`stopped by ${e}`, p => p.hits[e], true]),
    ...engines.map(e => [`mean gap at ${e}'s stop`, p => p.hits[e] ? length(p.stops[e]) : '', true]),
  ], data.pairs);

  const bars = data.frames.map(f => ({...f, run: name(f), median: 1e3 * f.median, p99: 1e3 * f.p99, worst: 1e3 * f.worst, touching_median: 1e3 * f.touching_median}));
  const y = {field: 'run', type: 'nominal', sort: null, title: null};
  const x = field => ({field, type: 'quantitative', scale: {type: 'log'}, title: 'time of a frame (ms)', axis: {values: [0.01, 0.1, 1, 10, 100]}});
  draw('frames', bars, {
    height: 22 * bars.length,
    layer: [
      {data: {values: [{ms: 1}]}, mark: {type: 'rule', color: '#57606a', strokeDash: [5, 3]}, encoding: {x: x('ms')}},
      {mark: {type: 'rule', color: '#57606a'}, encoding: {y, x: x('median'), x2: {field: 'worst'}}},
      {mark: {type: 'bar', height: 11, color: '#4b2bd7', tooltip: true}, encoding: {y, x: x('median'), x2: {field: 'p99'}}},
      {mark: {type: 'tick', color: '#ea8883', thickness: 3, size: 16}, encoding: {y, x: x('touching_median')}},
    ],
  });
  table('frame-table', [
    ['scene', s => s.scene], ['parts', s => s.parts], ['m/s', s => s.speed, true], ['triangles', s => count(s.triangles), true],
    ['bytes a triangle', s => count(s.bytes_per_triangle), true],
    ['median (ms)', s => ms(s.median), true], ['touching', s => ms(s.touching_median), true], ['p95', s => ms(s.p95), true],
    ['p99', s => ms(s.p99), true], ['worst', s => ms(s.worst), true], ['whole frame, median (ms)', s => ms(s.whole_median), true],
    ['search, rows given back, times of contact (mean ms)', s => `${ms(s.touches)} + ${ms(s.manifold)} + ${ms(s.toc)}`, true],
    ['contacts, raw', s => count(s.raw), true], ['most', s => count(s.most_raw), true], ['kept', s => s.kept.toFixed(1), true],
    ['given back', s => count(s.completed), true],
    ['frames', s => count(s.frames), true], ['truncations', s => count(s.truncations), true], ['held', s => count(s.held), true],
  ], data.frames);
  table('audit-table', [
    ['scene', s => s.scene], ['m/s', s => s.speed, true], ['rad a frame', s => s.spin || '', true],
    ['body-frames', s => count(s.body_frames), true], ['touching', s => count(s.touching), true], ['poses looked at', s => count(s.audited), true],
    ['penetrations', s => s.penetrations, true], ['smallest gap', s => length(s.gap), true], ['truncations', s => count(s.truncations), true],
  ], data.audits, (title, s) => title === 'penetrations' ? (s.penetrations ? 'bad' : 'good') : '');

  const c = data.conditions;
  table('conditions', [['', r => r[0]], ['', r => r[1]]], [
    ['command', data.command], ...['version', 'commit', 'compiler', 'flags', 'build', 'CPU', 'cores'].map(k => [k, String(c[k])]),
    ...Object.entries(c.libraries),
  ]);
})();
