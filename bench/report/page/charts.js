// What the page and the figures for print share: colours, label expressions, chart specs and the rows they draw.
(() => {
  // Fourteen colours that stay apart for colour-blind readers too. In grey print the marker's shape and the dash tell
  // solvers apart: fourteen shapes, and neighbours differ in their dash.
  const palette = {
    light: ['#4b2bd7', '#019bc2', '#923f67', '#ea8883', '#6e4604', '#819808', '#9553ff',
            '#21bfbb', '#623391', '#96acfe', '#7a742f', '#b06c81', '#4d6fb7', '#a3c003'],
    dark: ['#7f7af5', '#52abca', '#c27a9b', '#ed9d98', '#b08a5a', '#94a84d', '#a377fd',
           '#62c9c5', '#9a78cc', '#a8bafd', '#aba568', '#cf9aa9', '#7d9be0', '#b2cb58'],
  };
  const dashes = [[1, 0], [7, 3], [2, 2.5], [9, 3, 2, 3], [14, 4], [6, 2, 1.5, 2, 1.5, 2]];
  const shapes = [
    'M.9,0A.9,.9,0,1,1,-.9,0A.9,.9,0,1,1,.9,0Z', 'M-.8,-.8L.8,-.8L.8,.8L-.8,.8Z', 'M0,-1L1,.8L-1,.8Z', 'M0,-1.1L1.1,0L0,1.1L-1.1,0Z', 'M0,1L-1,-.8L1,-.8Z',
    'M-.35,-1L.35,-1L.35,-.35L1,-.35L1,.35L.35,.35L.35,1L-.35,1L-.35,.35L-1,.35L-1,-.35L-.35,-.35Z', 'M1,0L-.8,-1L-.8,1Z',
    'M0,-1.2L.3,-.4L1.1,-.37L.48,.15L.7,.97L0,.5L-.7,.97L-.48,.15L-1.1,-.37L-.3,-.4Z', 'M-1,-1L1,-1L-1,1L1,1Z', 'M-1,0L.8,-1L.8,1Z',
    'M-1,-.55L-.55,-1L0,-.45L.55,-1L1,-.55L.45,0L1,.55L.55,1L0,.45L-.55,1L-1,.55L-.45,0Z', 'M-.4,-1.1L.4,-1.1L.4,1.1L-.4,1.1Z', 'M-1,-1L1,1L1,-1L-1,1Z', 'M-1.1,-.4L1.1,-.4L1.1,.4L-1.1,.4Z',
  ];
  const themes = {
    light: {background: '#ffffff', ink: '#1b1f24', muted: '#57606a', grid: '#e4e7eb', empty: '#eceef1', wrong: '#d6001c'},
    dark: {background: '#14171c', ink: '#e6e9ee', muted: '#9aa4b1', grid: '#2b3038', empty: '#23272e', wrong: '#ff5c63'},
  };

  // Colour, dash and shape of each solver, the same in every chart; those shown by default come first, so that they differ.
  // Of two runs, the second is dashed.
  function styles(solvers, theme) {
    const order = [...new Set([...solvers.filter(s => s.shown), ...solvers].map(s => s.style))];
    const two_runs = solvers.some(s => s.second);
    return solvers.map(s => {
      const i = order.indexOf(s.style);
      return {
        name: s.name,
        color: palette[theme][i % 14],
        dash: dashes[two_runs ? (s.second ? 1 : 0) : i % dashes.length],
        shape: shapes[(i + 3 * Math.floor(i / 14)) % 14],
      };
    });
  }

  const superscript = text => String(text).replace(/[-0-9]/g, c => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]);
  const mantissa = value => value / 10 ** Math.floor(Math.log10(value) + 1e-9);
  const decades = ([low, high]) => Math.log10(high / low);

  // 3.2e-9 as people write it.
  function scientific(value) {
    if (value === null || value === undefined || Number.isNaN(value)) return 'unknown';
    if (value === 0) return '0 (exact)';
    if (value >= 1.7e308) return 'infinite';
    const [m, e] = value.toExponential(1).split('e');
    return e === '+0' ? m : `${m === '1.0' ? '' : m + '·'}10${superscript(Number(e))}`;
  }

  function duration(seconds) {
    if (seconds === null || seconds === undefined) return 'unknown';
    for (const [size, unit] of [[1, 's'], [1e-3, 'ms'], [1e-6, 'µs'], [1e-9, 'ns']])
      if (seconds >= size || unit === 'ns') return `${Number((seconds / size).toPrecision(3))} ${unit}`;
  }

  // Decades; 2 and 5 only where the axis is short, odd ones where it is very short, and the steps of a fifth or a few where
  // fewer than two of those lie on it. Vega's own ticks, some twenty, have them among them.
  const is_labelled = (value, domain, short, finest = 0) => {
    const span = decades(domain), [low, high] = domain;
    const is_round = at => {
      const m = mantissa(at), whole = Math.round(m);
      return Math.abs(m - whole) < 1e-6 && (whole === 1 || (span < short && [2, 5].includes(whole)) || (span < 1 && whole % 2 === 1));
    };
    if (span >= 1) return is_round(value);
    if (!(low < high)) return true;
    const wholes = [0, 1].flatMap(k => [1, 2, 3, 5, 7, 9].map(whole => whole * 10 ** (Math.floor(Math.log10(low)) + k)));
    if (wholes.filter(at => at >= low && at <= high).length > 1) return is_round(value);
    const fifth = (high - low) / 4, power = 10 ** Math.floor(Math.log10(fifth)), over = fifth / power;
    const step = Math.max(finest, power * (over >= Math.sqrt(50) ? 10 : over >= Math.sqrt(10) ? 5 : over >= Math.sqrt(2) ? 2 : 1));
    return Math.abs(value / step - Math.round(value / step)) < 1e-6;
  };
  const functions = {
    power_label: (value, domain) => {
      const m = Math.round(mantissa(value));
      return domain && !is_labelled(value, domain, 2.3) ? '' : `${m === 1 ? '' : `${m}·`}10${superscript(Math.round(Math.log10(value / m)))}`;
    },
    time_label: (value, domain) => is_labelled(value, domain, 2.3) ? duration(value) : '',
    size_label: (value, domain) => is_labelled(value, domain, 3, 1) ? value.toLocaleString('en') : '',
    // A problem's knob value stands for it: "GAP(k=44)" -> 44; powers of two far from 1 as such.
    knob_label: problem => {
      const text = /=([^,)]*)/.exec(problem)?.[1] ?? '', power = Math.log2(text);
      return Number.isInteger(power) && (power < -3 || power > 9) ? `2${superscript(power)}` : text;
    },
    ticks: domain => decades(domain) > 3.5 ? Math.floor(decades(domain)) : 20,
    is_decade: value => mantissa(value) < 1.5,
  };
  const register = vega => { for (const name in functions) vega.expressionFunction(name, functions[name]); };

  // Walks a spec and puts values where "$NAME" stands.
  function filled(node, values) {
    if (Array.isArray(node)) return node.map(item => filled(item, values));
    if (node && typeof node === 'object')
      return Object.fromEntries(Object.entries(node).map(([key, value]) => [key, filled(value, values)]));
    return typeof node === 'string' && node[0] === '$' && node.slice(1) in values ? values[node.slice(1)] : node;
  }

  // The layers that write solvers' names into a chart (labels.js): leader lines, and the text on a halo.
  const label_layers = c => {
    const text = {type: 'text', fontSize: 11, align: {expr: 'datum.align'}, dx: {expr: 'datum.shift'}, baseline: 'middle', tooltip: null};
    const drawn = {transform: [{filter: "datum.part === 'label'"}]};
    const encoding = (color, focused = 1) => ({
      text: {field: 'text'}, color: {value: color}, opacity: {condition: {test: "focus === '' || datum.solver === focus", value: focused}, value: 0.15},
    });
    return {
      LEADERS: {transform: [{filter: "datum.part === 'label' && datum.far"}], mark: {type: 'rule', strokeWidth: 0.8, tooltip: null},
                encoding: {x2: {field: 'from_x'}, y2: {field: 'from_y'}, color: {value: c.muted}}},
      HALOS: {...drawn, mark: {...text, stroke: c.background, strokeWidth: 3}, encoding: encoding(c.background, 0.8)},
      NAMES: {...drawn, mark: text, encoding: {...encoding(c.ink), color: {field: 'solver', type: 'nominal'}}},
    };
  };

  // Where a chart is better, as a word at its corner; and a key of the glyphs above it (labels.js).
  const corners = {LOWER_LEFT: ['↙ better', 'height', 14, 'top'], LOWER: ['↓ better', 'height', 14, 'top'], UPPER_LEFT: ['↖ better', 0, -6, 'bottom']};
  const fixed = c => ({color: {value: c.muted}, opacity: {value: 1}});
  const corner_layers = c => Object.fromEntries(Object.entries(corners).map(([name, [words, y, dy, baseline]]) => [name, {
    data: {values: [{words}]},
    mark: {type: 'text', clip: false, align: 'right', baseline, dx: -4, dy, fontSize: 11, fontWeight: 'bold', tooltip: null},
    encoding: {x: {value: 0}, y: {value: y}, text: {field: 'words'}, ...fixed(c)},
  }]));
  const key_layers = c => {
    const place = {x: {field: 'x', type: 'quantitative', scale: null, axis: null}, y: {field: 'y', type: 'quantitative', scale: null, axis: null}};
    const glyph = (kind, mark) => ({transform: [{filter: `datum.kind === '${kind}'`}], mark: {clip: false, tooltip: null, ...mark}});
    const point = more => ({type: 'point', ...more}), cross = 'M-.7,-.7L.7,.7M-.7,.7L.7,-.7';
    return {
      data: {values: '$KEY_ROWS'},
      encoding: {...place, ...fixed(c)},
      layer: [
        glyph('ok', point({filled: true, size: 62})), glyph('lone', point({filled: true, size: 20})), glyph('missed', point({size: 30, strokeWidth: 1.1})),
        glyph('undecided', point({size: 44, strokeWidth: 1.1, strokeDash: [1.5, 1.5]})), glyph('failed', point({size: 50, strokeWidth: 1.6})),
        glyph('bar', point({shape: 'M0,-1L0,1', size: 90, strokeWidth: 1.6})), glyph('line', point({shape: 'M-1,0L1,0', size: 160, strokeWidth: 1.5, strokeDash: [2, 3]})),
        {...glyph('wrong', {type: 'circle', size: 150, opacity: 0.34}), encoding: {color: {value: c.wrong}, opacity: {value: 0.34}}},
        glyph('wrong', point({shape: cross, size: 80, strokeWidth: 2})),
        {...glyph('solver', point({filled: true, size: 62})), encoding: {
          color: {field: 'words', type: 'nominal', scale: {domain: '$SOLVERS', range: '$COLORS'}, legend: null},
          shape: {field: 'words', type: 'nominal', scale: {domain: '$SOLVERS', range: '$SHAPES'}, legend: null},
        }},
        {mark: {type: 'text', align: 'left', baseline: 'middle', dx: 9, fontSize: 10, clip: false, tooltip: null}, encoding: {text: {field: 'words'}}},
      ],
    };
  };

  const config = (theme, font) => {
    const c = themes[theme];
    return {
      background: theme === 'light' && font ? 'white' : 'transparent',
      font: font || '"Segoe UI", Arial, "Liberation Sans", sans-serif',
      view: {stroke: c.grid},
      title: {anchor: 'start', frame: 'group', color: c.ink, subtitleColor: c.muted, fontSize: 14, subtitleFontSize: 10, offset: 10},
      axis: {labelColor: c.muted, titleColor: c.ink, gridColor: c.grid, domainColor: c.muted, tickColor: c.muted,
             labelFontSize: 11, titleFontSize: 12, titleFontWeight: 'normal', titlePadding: 8},
      legend: {labelColor: c.ink, titleColor: c.muted, labelFontSize: 11, titleFontSize: 11, symbolSize: 70, rowPadding: 3,
               labelLimit: 260, symbolStrokeWidth: 2},
      header: {labelColor: c.ink, titleColor: c.ink, labelFontSize: 12, labelFontWeight: 'bold', labelPadding: 4},
      text: {color: c.ink},
    };
  };

  // All text of one size [px].
  function one_size(node, size) {
    for (const [key, value] of Object.entries(node))
      if (/fontSize$/i.test(key)) node[key] = size;
      else if (value && typeof value === 'object' && key !== 'values') one_size(value, size);
  }

  // Titles of axes in lines that are no longer than the axis [px].
  function break_titles(node, plot) {
    for (const [channel, length] of [['x', plot.width], ['y', plot.height]]) {
      const {title} = node[channel] ?? {}, letters = Math.max(12, Math.floor(length / 5.8));
      if (typeof title === 'string' && title.length > letters)
        node[channel].title = title.split(' ').reduce((lines, word) =>
          `${lines.at(-1)} ${word}`.length > letters ? [...lines, word] : [...lines.slice(0, -1), `${lines.at(-1)} ${word}`.trim()], ['']);
    }
    for (const value of Object.values(node)) if (value && typeof value === 'object' && !Array.isArray(value.values)) break_titles(value, plot);
  }

  // A chart's spec with its colours, words and rows. Where names stand in the chart it needs no legend; on the page the
  // chips are one.
  function spec(template, rows, solvers, {theme = 'light', words = {}, font, size, width, plot} = {}) {
    const shown = new Set(rows.map(row => row.solver));
    const style = styles(solvers, theme).filter(s => width === 'container' || shown.has(s.name));
    const c = themes[theme];
    const values = {
      SOLVERS: style.map(s => s.name), COLORS: style.map(s => s.color), DASHES: style.map(s => s.dash), SHAPES: style.map(s => s.shape),
      WRONG: c.wrong, EMPTY: c.empty, BACKGROUND: c.background, MUTED: c.muted, ...label_layers(c), ...corner_layers(c), ...words,
    };
    const out = filled(template, {...values, KEY: filled(key_layers(c), values)});
    out.data = {name: 'rows', values: rows};
    out.config = config(theme, font);
    if (size) one_size(out, size);
    if (plot) break_titles(out, plot);
    if (size) Object.assign(out.config.legend, {orient: 'bottom', columns: Math.max(1, Math.floor(plot.width / 130))});
    const is_facet = 'facet' in out;
    const no_legend = node => {
      if (!node || typeof node !== 'object') return;
      for (const channel of ['color', 'shape', 'strokeDash']) if (node[channel]?.field === 'solver') node[channel].legend = null;
      Object.values(node).forEach(no_legend);
    };
    if (width === 'container' || rows.some(row => row.part === 'label')) no_legend(out);
    if (width === 'container' && !is_facet) {
      out.width = 'container';
      out.autosize = {type: 'fit-x', contains: 'padding'};
    }
    return out;
  }

  // Classes of problems never share a chart or a mean: the data of one of them stand in its place.
  const take_class = (data, k) => {
    data.common ??= data.tables;
    const {charts, families, tables} = data.classes[k];
    Object.assign(data, {charts, families, tables: {...data.common, ...tables}});
    return data.classes[k];
  };

  const unpacked = new Map();
  function all_rows(data, name) {
    const {fields, rows} = data.charts[name];
    if (!unpacked.has(rows)) unpacked.set(rows, rows.map(row => Object.fromEntries(fields.map((field, i) => [field, row[i]]))));
    return unpacked.get(rows);
  }

  // Two strips beside the axis of errors hold what has no place on it: errors from 0 to 1e-17 at the left, runs without
  // an answer at the right. Across a strip x means nothing, so its columns only keep markers apart.
  const exact_columns = [-18.0, -18.6, -19.2, -17.4], columns_apart = 1.25;
  function into_columns(rows) {
    const lowest = exact_columns.map(() => 0);  // the time of each column's last marker
    return [...rows].sort((a, b) => a.time - b.time).map(row => {
      const free = lowest.findIndex(time => row.time > columns_apart * time);
      const column = free < 0 ? lowest.indexOf(Math.min(...lowest)) : free;
      lowest[column] = row.time;
      return {...row, x: 10 ** exact_columns[column]};
    });
  }

  const is_recorded = row => row.drawn === 'recorded';
  const stands_in_medians = row => row.level !== 'run' || !(row.drawn === 'ok' || is_recorded(row));

  // Runs, or medians over a family, ready to draw. An exact solver's answer does not depend on the tolerance: of its right
  // runs, or medians, the tightest tolerance stands for all. Among medians, a run that has none is a dot off the line.
  function placed(whole, data, state, among_medians) {
    const rows = state.time === 'own' ? whole.map(without_preparation) : whole;
    const exact = new Set(data.solvers.filter(s => s.exact).map(s => s.name));
    const lanes = new Map(data.solvers.map((s, i) => [s.name, 10 ** (0.75 + 0.9 * i / data.solvers.length)]));
    const drawn = rows.map(row => ({...placed_one(row, among_medians, lanes.get(row.solver)), exact: exact.has(row.solver)}));
    const key = row => `${row.family} ${row.solver}`, stands_for_all = row => row.exact && row.drawn === 'ok';
    const tightest = {};
    for (const row of drawn.filter(stands_for_all)) if (!(tightest[key(row)]?.tolerance <= row.tolerance)) tightest[key(row)] = row;
    const kept = drawn.filter(row => !stands_for_all(row) || tightest[key(row)] === row);
    const in_strip = row => row.x <= 1e-17 && !is_recorded(row);
    const families = [...new Set(kept.map(row => row.family))];
    return [...kept.filter(row => !in_strip(row)), ...families.flatMap(family => into_columns(kept.filter(row => in_strip(row) && row.family === family)))];
  }
  // What the method itself takes; at least a hundredth, since the two are not timed in the same solve.
  function without_preparation(row) {
    const less = time => time === null ? null : Math.max(time - (row.prepare ?? 0), 0.01 * time);
    return {...row, time: less(row.time), q1: less(row.q1), q3: less(row.q3)};
  }
  function placed_one(row, among_medians, lane) {
    const in_strip = row.drawn === 'failed' || row.error === null;
    return {
      ...row,
      drawn: among_medians && row.level === 'lone' ? 'lone' : row.drawn,
      x: in_strip ? lane : Math.min(Math.max(row.error, is_recorded(row) ? 5e-19 : 0), 3),
      error_text: row.error === null ? 'unknown' : (row.drawn === 'undecided' ? '≤ ' : '') + scientific(row.error),
      time_text: is_recorded(row) ? 'none' : duration(row.time) + (row.q1 === null ? '' : `  [${duration(row.q1)}, ${duration(row.q3)}]`),
      tolerance_text: scientific(row.tolerance),
    };
  }

  const relative_error = 'relative error |z − z*| / max(|z_u|, |z*|), M-norm';
  const measures = {
    z_error: relative_error,
    primal: 'worst violated row, over the same',
    stationarity: 'stationarity |y − Gᵀλ|, over the same',
    gap: 'duality gap, over the same squared',
  };
  const converging = (data, state, axis) => all_rows(data, 'convergence')
    .filter(row => state.on.has(row.solver) && row.problem === state.trace && row[state.measure] !== null && row[axis] !== null)
    .map(row => ({...row, x: Math.max(row[axis], axis === 'time' ? 1e-9 : 1), y: Math.max(row[state.measure], 1e-17),
                  value_text: scientific(row[state.measure]), time_text: duration(row.time)}));

  // A table's rows by names of its columns: {family: cell, ...}.
  function table_rows(data, id, columns) {
    const table = data.tables[id];
    if (!table) return [];
    const at = Object.entries(columns).map(([key, name]) => [key, table.columns.findIndex(column => column.name === name)]);
    return table.rows.map(row => ({...Object.fromEntries(at.map(([key, i]) => [key, row.cells[i]])), solver: row.solver}));
  }
  // A heat map's head names what goes from benign to hard; a solver that reads none of the families has no row.
  const knobs = Object.fromEntries((typeof STABILITY === 'undefined' ? [] : STABILITY).map(of => [of.family, of.knob]));
  const panel = row => `${row.family}: ${knobs[row.family] ?? row.knob}`;
  const readers = data => new Set(all_rows(data, 'sweep').filter(row => row.state !== '').map(row => row.solver));
  const share_text = row => `${Math.round(100 * row.share)} % of the ${row.reads} it reads`;
  const speed_rows = data => table_rows(data, 'speed', {family: 'family', size: 'size', time: 'time', ratio: 'x ours', verified: 'verified', error: 'worst z_error'})
    .filter(row => row.ratio.value !== undefined);
  const speed_families = data => [...new Set(speed_rows(data).map(row => row.family.text))];
  const sizes_of = (data, family) => {
    const sizes = new Map(speed_rows(data).filter(row => row.family.text === family).map(row => [row.size.text, row.size.value ?? 0]));
    return [...sizes.keys()].sort((a, b) => sizes.get(a) - sizes.get(b));
  };

  // The rows each chart draws, from everything the page holds and what its reader chose.
  const rows = {
    'work-precision': (data, state) => placed(all_rows(data, 'work-precision')
      .filter(row => (state.on.has(row.solver) || is_recorded(row)) && row.family === state.family)
      .filter(row => state.problem ? row.problem === state.problem && row.level !== 'median' : stands_in_medians(row)), data, state, !state.problem),
    'families': (data, state) => placed(all_rows(data, 'work-precision')
      .filter(row => (state.on.has(row.solver) || is_recorded(row)) && stands_in_medians(row)), data, state, true),
    'profile': (data, state) => all_rows(data, 'profile')
      .filter(row => row.kind === 'ratio' && state.on.has(row.solver) && row.family === state.group && row.level === state.level)
      .map(row => ({...row, share_text: share_text(row)})),
    'data-profile': (data, state) => all_rows(data, 'profile')
      .filter(row => row.kind === 'time' && state.on.has(row.solver) && row.family === state.group && row.level === state.level)
      .map(row => ({...row, share_text: share_text(row), time_text: duration(row.at)})),
    'convergence-iteration': (data, state) => converging(data, state, 'iteration'),
    'convergence-time': (data, state) => converging(data, state, 'time'),
    'scaling': (data, state) => [
      ...all_rows(data, 'scaling').filter(row => state.on.has(row.solver) && row.family === state.sweep)
        .map(row => ({...row, part: 'point', time_text: duration(row.time)})).sort((a, b) => a.size - b.size),
      ...all_rows(data, 'fit').filter(row => state.on.has(row.solver) && row.family === state.sweep).map(row => ({...row, part: 'fit'})),
    ],
    'sweep': (data, state) => all_rows(data, 'sweep')
      .filter(function (row) { return state.listed.has(row.solver) && this.has(row.solver); }, readers(data))
      .map(row => ({...row, panel: panel(row), log_error: row.error === null ? null : Math.log10(Math.min(Math.max(row.error, 1e-16), 1)),
                    error_text: scientific(row.error)})),
    'range-gap': (data, state) => all_rows(data, 'range-gap')
      .filter(row => state.on.has(row.solver))
      .map(row => ({...row, x: Math.max(row.gap, 1e-17), y: Math.max(row.error, 1e-17), drawn: row.claimed === 'solved' && row.verified === 'wrong' ? 'wrong' : 'ok',
                    gap_text: scientific(row.gap), error_text: scientific(row.error)})),
    'speed-ratios': (data, state) => {
      const sizes = sizes_of(data, state.size_family);
      return speed_rows(data).filter(row => row.family.text === state.size_family && state.on.has(row.solver)).map(row => ({
        solver: row.solver, position: sizes.indexOf(row.size.text), ratio: row.ratio.value, size_text: row.size.text, time_text: row.time.text.replace(' us', ' µs'),
        verified: row.verified.text, error_text: row.error.text, right: row.verified.tone === 'good', bound: row.ratio.text.startsWith('>'), ratio_text: row.ratio.text.replace(/x$/, '×'),
      }));
    },
    'speed-exponents': (data, state) =>
      table_rows(data, 'speed-exponents', {family: 'family', solver: 'solver', sizes: 'sizes', exponent: 'exponent p', error: '2 s.e.'})
        .filter(row => state.listed.has(row.solver))
        .map(row => ({solver: row.solver, family: `${row.family.text}, ${row.sizes.text}`, exponent: row.exponent.value, text: row.exponent.text,
                      low: row.exponent.value - (row.error.value ?? 0), high: row.exponent.value + (row.error.value ?? 0)})),
    'stages': data => all_rows(data, 'stages').filter(row => row.time !== null)
      .map(row => ({...row, microseconds: 1e6 * row.time, time_text: duration(row.time), share_text: `${Math.round(100 * row.share)} %`})),
  };

  // Words that belong into a chart: axis titles cannot be expressions.
  const words = {
    'convergence-iteration': (data, state) => ({MEASURE: measures[state.measure]}),
    'convergence-time': (data, state) => ({MEASURE: measures[state.measure]}),
    'speed-ratios': (data, state) => {
      const sizes = sizes_of(data, state.size_family);
      return {POSITIONS: sizes.map((_, i) => i), SIZE_LABELS: `${JSON.stringify(sizes)}[datum.value]`};
    },
    // Room for the numbers beside the bars.
    'speed-exponents': (data, state) => ({X_MAX: 1.3 * Math.max(1, ...rows['speed-exponents'](data, state).map(row => row.high))}),
    'scaling': (data, state) => ({SIZE: all_rows(data, 'scaling').find(row => row.family === state.sweep)?.axis ?? 'size'}),
    'sweep': data => ({PANELS: [...new Set(all_rows(data, 'sweep').map(panel))]}),
  };

  globalThis.zwang_charts = {palette, config, styles, register, spec, rows, words, take_class, all_rows, speed_families, measures, relative_error, scientific, duration, superscript};
})();
