// The name of each solver beside its line or point, with a leader line where there is no room next to it.
(() => {
  'use strict';
  const {duration, relative_error} = zwang_charts;
  // px: width of a character, half the height of a line, distance to the point; how much nearer a name is to its own line, for a plot is
  // some pixels narrower or wider than it was taken for.
  const glyph = 6, half_line = 6.5, gap = 8, margin = 2;
  const reaches = [0, 14, 28, 42, 60, 80, 105, 135, 170, 220, 290];
  const angles = [0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6].map(k => k * Math.PI / 6);

  const between = (value, low, high) => value >= low && value <= high;
  const overlap = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

  const apart = (rect, p) => Math.hypot(Math.max(rect.left - p.x, 0, p.x - rect.right), Math.max(rect.top - p.y, 0, p.y - rect.bottom));

  // Where a name may stand: beside its anchor or farther off, and beside other points of its line; without what follows the
  // name where there is no room for that. What is nearest costs least.
  function* places(anchor) {
    for (const text of new Set([anchor.text, anchor.solver]))
      for (const from of [anchor, ...anchor.along])
        for (const reach of reaches)
          for (const angle of reach === 0 ? [0] : angles)
            for (const side of [1, -1]) {
              if (side * Math.cos(angle) < -0.01) continue;  // the name goes on from where its leader ends
              const at_x = from.x + reach * Math.cos(angle), at_y = from.y + reach * Math.sin(angle);
              const near = at_x + side * gap, far = near + side * glyph * text.length;
              const rect = {left: Math.min(near, far), right: Math.max(near, far), top: at_y - half_line, bottom: at_y + half_line};
              const cost = reach + (side < 0 ? 2 : 0) + (from === anchor ? 0 : 60) + (text === anchor.text ? 0 : 200);
              yield {...anchor, text, from, at_x, at_y, rect, cost, align: side > 0 ? 'left' : 'right', far: reach > 10};
            }
  }

  // Greedy point labelling: each anchor {x, y, text, solver, along} gets the cheapest place inside the box that covers no
  // label, no marker and as little as possible of the lines, and that is nearer to its own solver's points and line than to
  // any other's; a name that has no such place is left out. `occupied`: {x, y, solver, marker}. All in pixels.
  function place(anchors, occupied, box) {
    const crowd = a => anchors.filter(b => Math.hypot(a.x - b.x, a.y - b.y) < 60).length;
    const labels = [];
    for (const anchor of [...anchors].sort((a, b) => crowd(b) - crowd(a) || a.y - b.y)) {
      let best = {cost: Infinity};
      for (const spot of places(anchor)) {
        const {rect} = spot;
        if (spot.cost >= best.cost || rect.left < box.left || rect.right > box.right || rect.top < box.top || rect.bottom > box.bottom) continue;
        if (labels.some(label => overlap(rect, label.rect))) continue;
        let own = Infinity, others = Infinity;
        for (const p of occupied) {
          const off = apart(rect, p);
          if (p.solver === anchor.solver) own = Math.min(own, off);
          else others = Math.min(others, off);
          if (off < (p.marker ? 6 : 3)) spot.cost += p.marker ? Infinity : 12;
        }
        if (own + margin <= others && others >= 3 && spot.cost < best.cost) best = spot;
      }
      if (best.rect) labels.push(best);
    }
    return labels;
  }

  // The names of lines that end at the right edge, in one column beside it: in the order of the ends, as near to them as
  // the height of a line of text allows. Least squares under an order is isotonic regression (pool adjacent violators).
  function stack(anchors, box) {
    const line = 2 * half_line, at_x = Math.max(...anchors.map(a => a.x)) + 18;
    const sorted = [...anchors].sort((a, b) => a.y - b.y);
    const pools = [];
    sorted.forEach((anchor, i) => {
      pools.push({mean: anchor.y - i * line, count: 1});
      while (pools.length > 1 && pools[pools.length - 2].mean > pools[pools.length - 1].mean) {
        const {mean, count} = pools.pop(), before = pools[pools.length - 1];
        before.mean = (before.mean * before.count + mean * count) / (before.count += count);
      }
    });
    const offsets = pools.flatMap(pool => Array(pool.count).fill(pool.mean));
    const lowest = box.top + half_line, highest = box.bottom - half_line - (sorted.length - 1) * line;
    return sorted.map((anchor, i) => ({...anchor, from: anchor, at_x, at_y: Math.max(lowest, Math.min(highest, offsets[i])) + i * line, align: 'left', far: true}));
  }

  const axis = (log, [low, high], length) => {
    const to = log ? Math.log : Number, from = log ? Math.exp : Number;
    return {pixel: value => (to(value) - to(low)) / (to(high) - to(low)) * length, value: pixel => from(to(low) + pixel / length * (to(high) - to(low)))};
  };
  const between_points = (from, to) => {
    const steps = Math.ceil(Math.hypot(to.x - from.x, to.y - from.y) / 4);
    return Array.from({length: Math.max(steps - 1, 0)}, (_, k) => ({x: from.x + (to.x - from.x) * (k + 1) / steps, y: from.y + (to.y - from.y) * (k + 1) / steps}));
  };
  // Of what a logarithmic axis can show.
  const range = values => {
    const shown = values.filter(value => value > 0);
    return shown.length ? [Math.min(...shown), Math.max(...shown)] : [1e-6, 1];
  };
  const wider = ([low, high], left, right) => [low / left, high * right];
  // More room at the right, as much as names need.
  const with_margin = ([low, high], log, width) => {
    const share = 140 / Math.max(width - 140, 200);
    return log ? [low, high * (high / low) ** share] : [low, high + (high - low) * share];
  };

  // Of each chart: its fields, its domains, the rows that a line joins (in their order) and the row its name stands at.
  const last = line => line[line.length - 1];
  const by = (field, sign = 1) => (a, b) => sign * (a[field] - b[field]);
  const ending = {ok: 0, lone: 1, missed: 2, wrong: 3, undecided: 4, failed: 5};
  // Staircases end on each other at 100 %: a name stands beside its line's last rise.
  const last_rise = line => {
    const top = line.findIndex(row => row.share === last(line).share);
    return top > 0 ? {...line[top], share: (line[top - 1].share + line[top].share) / 2} : line[0].share > 0 ? line[0] : last(line);
  };
  const staircase = {x: 'at', y: 'share', linear_y: true, order: by('at'), steps: true, anchor: last_rise, domains: rows => [range(rows.map(row => row.at)), [0, 1]]};
  const charts = {
    'work-precision': {
      x: 'x', y: 'time', line: row => row.drawn === 'ok', order: by('tolerance', -1),
      domains: rows => [[2e-20, 60], wider(range(rows.flatMap(row => [row.time, row.q1 ?? row.time, row.q3 ?? row.time])), 1.6, 1.6)],
      words: (rows, width, solvers) => ({KEY_ROWS: key(rows, width, solvers), ERROR: width < 480 ? 'relative error of z' : relative_error}),
      text: row => row.exact && row.drawn === 'ok' ? `${row.solver}, ${duration(row.time)}` : row.solver,
    },
    'profile': staircase,
    'data-profile': staircase,
    'convergence-iteration': {x: 'x', y: 'y', order: by('x')},
    'convergence-time': {x: 'x', y: 'y', order: by('x')},
    'scaling': {x: 'size', y: 'time', to_right: true, line: row => row.part === 'point', order: by('size')},
    'speed-ratios': {
      x: 'position', y: 'ratio', linear_x: true, to_right: true, order: by('position'),
      domains: (rows, width) => [with_margin([-0.2, Math.max(1, ...rows.map(row => row.position)) + 0.1], false, width), wider(range(rows.map(row => row.ratio)), 1.6, 1.6)],
    },
  };

  // What the glyphs of speed against accuracy mean: those that are there, in lines above the plot; and solvers without a name in it.
  const glyphs = {
    ok: 'solved', bar: 'quartiles', lone: 'few solved', missed: 'stopped short, said so', undecided: 'not proven: upper bound', failed: 'no answer',
    wrong: 'claimed solved, is wrong', line: 'came with the problem',
  };
  function key(rows, width, solvers = []) {
    const is_there = kind => rows.some(row => kind === 'bar' ? row.drawn === 'ok' && (row.q1 ?? null) !== null : row.drawn === (kind === 'line' ? 'recorded' : kind));
    let x = 8, line = 0;
    const placed = [...Object.entries(glyphs).filter(([kind]) => is_there(kind)), ...solvers.map(name => ['solver', name])].map(([kind, words]) => {
      const wide = 9 + 5.2 * words.length + 18;
      if (x > 8 && x + wide - 10 > width) x = 8, ++line;
      x += wide;
      return {kind, words, x: x - wide, line};
    });
    return placed.map(at => ({...at, y: -11 - 15 * (line - at.line)}));
  }

  // The rows of a chart with the labels among them (part: "label"), the words its spec asks for, and the solvers
  // that have no label.
  function labelled(name, every, {width, height, best = [], most = width < 420 ? 5 : Infinity, in_key = []}) {
    const chart = charts[name];
    if (!chart) return {rows: every, words: {}, unnamed: []};
    const lines = every.filter(row => row.drawn === 'recorded'), rows = every.filter(row => row.drawn !== 'recorded');
    const {x, y, order, line = () => true, text = row => row.solver} = chart;
    const domains = chart.domains ?? (shown => [with_margin(wider(range(shown.map(row => row[x])), 1.2, 1), true, width), wider(range(shown.map(row => row[y])), 1.5, 1.5)]);
    const [x_domain, y_domain] = domains(rows, width);
    const across = axis(!chart.linear_x, x_domain, width), up = axis(!chart.linear_y, y_domain, height);
    const words = {X_DOMAIN: x_domain, Y_DOMAIN: y_domain, ...chart.words?.(every, width, in_key)};
    const drawn = [...new Set(rows.map(row => row.solver))], names = [...best.filter(name => drawn.includes(name)), ...drawn.filter(name => !best.includes(name))].slice(0, most);
    const pixel = row => ({x: across.pixel(row[x]), y: height - up.pixel(row[y])});
    const occupied = rows.map(row => ({...pixel(row), solver: row.solver, marker: true})), anchors = [];
    for (const solver of drawn) {
      const own = rows.filter(row => row.solver === solver);
      const joined = own.filter(line).sort(order);
      const corners = joined.flatMap((row, i) => chart.steps && i > 0 ? [{x: pixel(row).x, y: pixel(joined[i - 1]).y}, pixel(row)] : [pixel(row)]);
      const along = corners.flatMap((to, i) => i > 0 ? between_points(corners[i - 1], to).map(p => ({...p, solver})) : []);
      occupied.push(...along);
      if (!names.includes(solver)) continue;
      const row = (joined.length && (chart.anchor ?? last)(joined)) || [...own].sort((a, b) => ending[a.drawn] - ending[b.drawn] || a.x - b.x)[0];
      anchors.push({...pixel(row), row, solver, text: text(row), along: along.filter((p, i) => i % 7 === 3)});
    }
    const box = {left: 0, right: width, top: 0, bottom: height};
    const edge = Math.max(...anchors.map(a => a.x)) - 30, ends = anchors.filter(a => chart.to_right && a.x >= edge);
    const placed = [...ends.length ? stack(ends, box) : [], ...place(anchors.filter(a => !ends.includes(a)), occupied, box)];
    const labels = placed.map(label => ({
      solver: label.row.solver, part: 'label', drawn: 'label', text: label.text, align: label.align, far: label.far, shift: label.rect ? (label.align === 'left' ? gap : -gap) : 3,
      [x]: across.value(label.at_x), [y]: up.value(height - label.at_y), from_x: across.value(label.from.x), from_y: up.value(height - label.from.y),
    }));
    return {rows: [...rows, ...lines, ...labels], words, unnamed: drawn.filter(solver => !labels.some(label => label.solver === solver))};
  }

  globalThis.zwang_labels = {place, stack, key, labelled};
})();
