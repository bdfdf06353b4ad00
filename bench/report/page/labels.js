// The name of each solver beside its line or point, with a leader line where there is no room next to it.
(() => {
  'use strict';
  const {duration} = zwang_charts;
  const glyph = 6, half_line = 6.5, gap = 8;  // px: width of a character, half the height of a line, distance to the point
  const reaches = [0, 14, 28, 42, 60, 80, 105, 135, 170];
  const angles = [0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6].map(k => k * Math.PI / 6);

  const between = (value, low, high) => value >= low && value <= high;
  const overlap = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

  // Greedy point labelling: for each anchor {x, y, text} the nearest place inside the box that covers no label and as few
  // of the occupied points as possible; to_right: no label stands left of its anchor. All in pixels; each label gets
  // {at_x, at_y, align, far}.
  function place(anchors, occupied, box, to_right = false) {
    const crowd = a => anchors.filter(b => Math.hypot(a.x - b.x, a.y - b.y) < 60).length;
    const labels = [];
    for (const anchor of [...anchors].sort((a, b) => crowd(b) - crowd(a) || a.y - b.y)) {
      const width = glyph * anchor.text.length;
      let best = null;
      for (const reach of reaches)
        for (const angle of reach === 0 ? [0] : to_right ? angles.filter(a => Math.cos(a) > -0.01) : angles)
          for (const side of to_right ? [1] : [1, -1]) {
            const at_x = anchor.x + reach * Math.cos(angle), at_y = anchor.y + reach * Math.sin(angle);
            const near = at_x + side * gap, far = near + side * width;
            const rect = {left: Math.min(near, far), right: Math.max(near, far), top: at_y - half_line, bottom: at_y + half_line};
            if (rect.left < box.left || rect.right > box.right || rect.top < box.top || rect.bottom > box.bottom) continue;
            if (labels.some(label => overlap(rect, label.rect))) continue;
            const hidden = occupied.filter(p => between(p.x, rect.left - 3, rect.right + 3) && between(p.y, rect.top - 3, rect.bottom + 3)).length;
            const cost = reach + 12 * hidden + (side < 0 ? 2 : 0);
            if (!best || cost < best.cost) best = {...anchor, cost, rect, at_x, at_y, align: side > 0 ? 'left' : 'right', far: reach > 10};
          }
      if (best) labels.push(best);
    }
    return labels;
  }

  const axis = (log, [low, high], length) => {
    const to = log ? Math.log : Number, from = log ? Math.exp : Number;
    return {pixel: value => (to(value) - to(low)) / (to(high) - to(low)) * length, value: pixel => from(to(low) + pixel / length * (to(high) - to(low)))};
  };
  const range = values => [Math.min(...values), Math.max(...values)];
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
  const charts = {
    'work-precision': {
      x: 'x', y: 'time', line: row => row.drawn === 'ok', order: by('tolerance', -1),
      domains: rows => [[2e-20, 60], wider(range(rows.map(row => row.time)), 1.6, 1.6)],
      text: row => row.exact && row.drawn === 'ok' ? `${row.solver}, ${duration(row.time)}` : row.solver,
    },
    'profile': {x: 'at', y: 'share', linear_y: true, to_right: true, order: by('at'), domains: (rows, width) => [with_margin(range(rows.map(row => row.at)), true, width), [0, 1]]},
    'data-profile': {x: 'at', y: 'share', linear_y: true, to_right: true, order: by('at'), domains: (rows, width) => [with_margin(range(rows.map(row => row.at)), true, width), [0, 1]]},
    'convergence-iteration': {x: 'x', y: 'y', order: by('x')},
    'convergence-time': {x: 'x', y: 'y', order: by('x')},
    'scaling': {x: 'size', y: 'time', to_right: true, line: row => row.part === 'point', order: by('size')},
    'speed-ratios': {
      x: 'position', y: 'ratio', linear_x: true, to_right: true, order: by('position'),
      domains: (rows, width) => [with_margin([-0.2, Math.max(1, ...rows.map(row => row.position)) + 0.1], false, width), wider(range(rows.map(row => row.ratio)), 1.6, 1.6)],
    },
  };

  // The rows of a chart with the labels among them (part: "label"), and the words its spec asks for.
  function labelled(name, rows, {width, height}) {
    const chart = charts[name];
    if (!chart) return {rows, words: {}};
    const {x, y, order, line = () => true, text = row => row.solver} = chart;
    const domains = chart.domains ?? (shown => [with_margin(range(shown.map(row => row[x])), true, width), wider(range(shown.map(row => row[y])), 1.5, 1.5)]);
    const [x_domain, y_domain] = domains(rows, width);
    const across = axis(!chart.linear_x, x_domain, width), up = axis(!chart.linear_y, y_domain, height);
    const words = {X_DOMAIN: x_domain, Y_DOMAIN: y_domain};
    if (width < 420) return {rows, words};
    const pixel = row => ({x: across.pixel(row[x]), y: height - up.pixel(row[y])});
    const occupied = rows.map(pixel), anchors = [];
    for (const solver of new Set(rows.map(row => row.solver))) {
      const own = rows.filter(row => row.solver === solver);
      const joined = own.filter(line).sort(order);
      joined.forEach((row, i) => {
        if (i === 0) return;
        const from = pixel(joined[i - 1]), to = pixel(row), steps = Math.ceil(Math.hypot(to.x - from.x, to.y - from.y) / 7);
        for (let k = 1; k < steps; ++k) occupied.push({x: from.x + (to.x - from.x) * k / steps, y: from.y + (to.y - from.y) * k / steps});
      });
      const row = last(joined) ?? [...own].sort((a, b) => ending[a.drawn] - ending[b.drawn] || a.x - b.x)[0];
      anchors.push({...pixel(row), row, text: text(row)});
    }
    const labels = place(anchors, occupied, {left: 0, right: width, top: 4, bottom: height - 4}, chart.to_right).map(label => ({
      solver: label.row.solver, part: 'label', drawn: 'label', text: label.text, align: label.align, far: label.far, shift: label.align === 'left' ? gap : -gap,
      [x]: across.value(label.at_x), [y]: up.value(height - label.at_y), from_x: label.row[x], from_y: label.row[y],
    }));
    return {rows: [...rows, ...labels], words};
  }

  globalThis.zwang_labels = {place, labelled};
})();
