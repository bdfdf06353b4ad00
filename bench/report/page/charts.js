// What the page and the figures for print share: colours, label expressions, chart specs and the rows they draw.
(() => {
  // Fourteen colours that stay apart for colour-blind readers too; the first seven are drawn solid, the next dashed. A
  // third seven has the colours of the first, dotted and with other shapes.
  const palette = {
    light: ['#4b2bd7', '#019bc2', '#923f67', '#ea8883', '#6e4604', '#819808', '#9553ff',
            '#21bfbb', '#623391', '#96acfe', '#7a742f', '#b06c81', '#4d6fb7', '#a3c003'],
    dark: ['#7f7af5', '#52abca', '#c27a9b', '#ed9d98', '#b08a5a', '#94a84d', '#a377fd',
           '#62c9c5', '#9a78cc', '#a8bafd', '#aba568', '#cf9aa9', '#7d9be0', '#b2cb58'],
  };
  const dashes = [[1, 0], [6, 3], [2, 3]];
  const shapes = ['circle', 'square', 'triangle-up', 'diamond', 'triangle-down', 'cross', 'triangle-right'];
  const themes = {
    light: {background: '#ffffff', ink: '#1b1f24', muted: '#57606a', grid: '#e4e7eb', empty: '#eceef1', wrong: '#d6001c'},
    dark: {background: '#14171c', ink: '#e6e9ee', muted: '#9aa4b1', grid: '#2b3038', empty: '#23272e', wrong: '#ff5c63'},
  };

  // Colour, dash and shape of each solver, the same in every chart. Of two runs, the second is dashed.
  function styles(solvers, theme) {
    const order = [...new Set(solvers.map(s => s.style))];
    const two_runs = solvers.some(s => s.second);
    return solvers.map(s => {
      const i = order.indexOf(s.style);
      return {
        name: s.name,
        color: palette[theme][i % 14],
        dash: dashes[two_runs ? (s.second ? 1 : 0) : Math.floor(i / 7) % 3],
        shape: shapes[(i + 3 * Math.floor(i / 14)) % 7],
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

  const is_labelled = (value, span, short) => {
    const m = mantissa(value), whole = Math.round(m);
    return Math.abs(m - whole) < 1e-6 && (whole === 1 || (span < short && [2, 5].includes(whole)) || (span < 1 && whole % 2 === 1));
  };
  const functions = {
    power_label: value => `10${superscript(Math.round(Math.log10(value)))}`,
    // Label decades; 2 and 5 only where the axis is short, odd ones where it is very short.
    time_label: (value, domain) => is_labelled(value, decades(domain), 2.3) ? duration(value) : '',
    size_label: (value, domain) => is_labelled(value, decades(domain), 3) ? value.toLocaleString('en') : '',
    // A problem's knob value stands for it: "GAP(k=44)" -> 44.
    knob_label: problem => /=([^,)]*)/.exec(problem)?.[1] ?? '',
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

  // A chart's spec with its colours, words and rows. On the page the chips are the legend.
  function spec(template, rows, solvers, {theme = 'light', words = {}, font, title, width} = {}) {
    const shown = new Set(rows.map(row => row.solver));
    const style = styles(solvers, theme).filter(s => width === 'container' || shown.has(s.name));
    const c = themes[theme];
    const out = filled(template, {
      SOLVERS: style.map(s => s.name), COLORS: style.map(s => s.color), DASHES: style.map(s => s.dash), SHAPES: style.map(s => s.shape),
      WRONG: c.wrong, EMPTY: c.empty, BACKGROUND: c.background, DARK: theme === 'dark', ...words,
    });
    out.data = {name: 'rows', values: rows};
    out.config = config(theme, font);
    if (title) out.title = title;
    const is_facet = 'facet' in out;
    if (width === 'container') {
      const no_legend = node => {
        if (!node || typeof node !== 'object') return;
        for (const channel of ['color', 'shape', 'strokeDash']) if (node[channel]?.field === 'solver') node[channel].legend = null;
        Object.values(node).forEach(no_legend);
      };
      no_legend(out);
      if (!is_facet) {
        out.width = 'container';
        out.autosize = {type: 'fit-x', contains: 'padding'};
      }
    }
    return out;
  }

  const unpacked = new Map();
  function all_rows(data, name) {
    if (!unpacked.has(name)) {
      const {fields, rows} = data.charts[name];
      unpacked.set(name, rows.map(row => Object.fromEntries(fields.map((field, i) => [field, row[i]]))));
    }
    return unpacked.get(name);
  }

  // One run, or the median over a family, ready to draw: errors below 1e-17 (0 is exact) sit at the left edge, runs
  // without an answer in the strip at the right. Among medians, a run that has none is a dot off the line.
  function placed(row, among_medians) {
    const in_strip = row.drawn === 'failed' || row.error === null;
    return {
      ...row,
      drawn: among_medians && row.level === 'lone' ? 'lone' : row.drawn,
      x: in_strip ? 20 : Math.min(Math.max(row.error, 1e-17), 3),
      error_text: row.error === null ? 'unknown' : (row.drawn === 'undecided' ? '≤ ' : '') + scientific(row.error),
      time_text: duration(row.time) + (row.q1 === null ? '' : `  [${duration(row.q1)}, ${duration(row.q3)}]`),
      tolerance_text: scientific(row.tolerance),
    };
  }

  const measures = {
    z_error: 'error of z against the reference, |z − z*| / s (1)',
    primal: 'worst violated row over the scale s (1)',
    stationarity: 'stationarity |y − Gᵀλ| / s (1)',
    gap: 'duality gap over s² (1)',
  };
  const converging = (data, state, axis) => all_rows(data, 'convergence')
    .filter(row => state.on.has(row.solver) && row.problem === state.trace && row[state.measure] !== null && row[axis] !== null)
    .map(row => ({...row, x: Math.max(row[axis], axis === 'time' ? 1e-9 : 1), y: Math.max(row[state.measure], 1e-17),
                  value_text: scientific(row[state.measure]), time_text: duration(row.time)}));

  // The rows each chart draws, from everything the page holds and what its reader chose.
  const rows = {
    'work-precision': (data, state) => all_rows(data, 'work-precision')
      .filter(row => state.on.has(row.solver) && row.family === state.family)
      .filter(row => state.problem ? row.problem === state.problem && row.level !== 'median' : row.level !== 'run' || row.drawn !== 'ok')
      .map(row => placed(row, !state.problem)),
    'families': (data, state) => all_rows(data, 'work-precision')
      .filter(row => state.on.has(row.solver) && (row.level !== 'run' || row.drawn !== 'ok'))
      .map(row => placed(row, true)),
    'profile': (data, state) => all_rows(data, 'profile')
      .filter(row => row.kind === 'ratio' && state.on.has(row.solver) && row.family === state.group && row.level === state.level)
      .map(row => ({...row, share_text: `${Math.round(100 * row.share)} %`})),
    'data-profile': (data, state) => all_rows(data, 'profile')
      .filter(row => row.kind === 'time' && state.on.has(row.solver) && row.family === state.group && row.level === state.level)
      .map(row => ({...row, share_text: `${Math.round(100 * row.share)} %`, time_text: duration(row.at)})),
    'convergence-iteration': (data, state) => converging(data, state, 'iteration'),
    'convergence-time': (data, state) => converging(data, state, 'time'),
    'scaling': (data, state) => [
      ...all_rows(data, 'scaling').filter(row => state.on.has(row.solver) && row.family === state.sweep)
        .map(row => ({...row, part: 'point', time_text: duration(row.time)})).sort((a, b) => a.size - b.size),
      ...all_rows(data, 'fit').filter(row => state.on.has(row.solver) && row.family === state.sweep).map(row => ({...row, part: 'fit'})),
    ],
    'sweep': (data, state) => all_rows(data, 'sweep')
      .filter(row => state.on.has(row.solver))
      .map(row => ({...row, log_error: row.error === null ? null : Math.log10(Math.min(Math.max(row.error, 1e-16), 1)),
                    error_text: scientific(row.error)})),
    'range-gap': (data, state) => all_rows(data, 'range-gap')
      .filter(row => state.on.has(row.solver))
      .map(row => ({...row, x: Math.max(row.gap, 1e-17), y: Math.max(row.error, 1e-17), drawn: row.claimed === 'solved' && row.verified === 'wrong' ? 'wrong' : 'ok',
                    gap_text: scientific(row.gap), error_text: scientific(row.error)})),
    'stages': data => all_rows(data, 'stages').filter(row => row.time !== null)
      .map(row => ({...row, microseconds: 1e6 * row.time, time_text: duration(row.time), share_text: `${Math.round(100 * row.share)} %`})),
  };

  // Words that belong into a chart: axis titles cannot be expressions.
  const words = {
    'convergence-iteration': (data, state) => ({MEASURE: measures[state.measure]}),
    'convergence-time': (data, state) => ({MEASURE: measures[state.measure]}),
    'scaling': (data, state) => ({SIZE: `${all_rows(data, 'scaling').find(row => row.family === state.sweep)?.axis ?? 'size'} (number)`}),
  };

  globalThis.zwang_charts = {palette, config, styles, register, spec, rows, words, all_rows, measures, scientific, duration, superscript};
})();
