// Below the view: marks, how deep the tracked hand is inside, and where the time of each step went, over the run.
import {marks} from './data.mjs';
import {css, integer, millimetres, milliseconds, seconds} from './words.mjs';
import {mark_colors, origin_colors, stage_colors, themes} from './palette.mjs';

const left = 46, top = 16, bottom = 16, between = 8;

// 1, 2 or 5 times a power of ten, at most `count` of them in `span`.
function tick_step(span, count) {
  const rough = span / count, ten = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].map(k => k * ten).find(step => step >= rough);
}

export function make_timeline(run, box, canvas, cursor, tip, seek) {
  const n = run.numbers, pen = canvas.getContext('2d'), last = run.frames - 1;
  const total = Float32Array.from(n.t, (_, f) => run.stages.reduce((sum, stage) => sum + Math.max(0, n[stage][f]), 0));
  // A rare slow step must not flatten the rest: the scale ends a little above the 99.5th percentile.
  const sorted = Float32Array.from(total).sort(), scale = Math.min(sorted[last], 1.25 * sorted[Math.floor(.995 * last)]) || 1e-3;
  const deepest = n.depth.reduce((a, b) => Math.max(a, b), 0);
  let theme = 'light', width = 0;
  const x_of = f => left + (last > 0 ? f / last : 0) * (width - left - 1);
  const frame_at = x => Math.max(0, Math.min(last, Math.round((x - left) / (width - left - 1) * last)));

  function draw() {
    const height = box.clientHeight, ratio = devicePixelRatio, style = getComputedStyle(document.documentElement), color = name => style.getPropertyValue(name).trim();
    width = box.clientWidth;
    if (width === 0) return;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.font = `11px ${getComputedStyle(document.body).fontFamily}`;
    const floor = height - bottom, depth_height = Math.round((floor - top - between) * .4), depth_floor = top + depth_height, time_top = depth_floor + between;

    // A column for each pixel, the largest of its frames: nothing that stands out is lost.
    const columns = Math.max(1, Math.floor(width - left)), first = c => Math.round(c / columns * run.frames);
    const largest = (values, c) => {
      let most = 0;
      for (let f = first(c), end = Math.max(f + 1, first(c + 1)); f < end && f <= last; f++) most = Math.max(most, values[f]);
      return most;
    };
    const mean = (values, c) => {
      let sum = 0, count = 0;
      for (let f = first(c), end = Math.max(f + 1, first(c + 1)); f < end && f <= last; f++, count++) sum += Math.max(0, values[f]);
      return count > 0 ? sum / count : 0;
    };

    pen.fillStyle = color('--well');
    pen.fillRect(left, top, width - left, depth_height);
    pen.fillRect(left, time_top, width - left, floor - time_top);
    pen.fillStyle = css(themes[theme].ghost);
    for (let c = 0; c < columns; c++) {
      const tall = deepest > 0 ? largest(n.depth, c) / deepest * (depth_height - 3) : 0;
      pen.globalAlpha = .38;
      pen.fillRect(left + c, depth_floor - tall, 1, tall);
      pen.globalAlpha = 1;
      if (tall > 0) pen.fillRect(left + c, depth_floor - tall, 1, 1.5);
    }
    const room = floor - time_top;
    for (let c = 0; c < columns; c++) {
      let base = floor;
      for (const stage of run.stages) {
        const tall = Math.min(mean(n[stage], c) / scale * room, base - time_top);
        pen.fillStyle = stage_colors[stage];
        pen.fillRect(left + c, base - tall, 1, tall);
        base -= tall;
      }
      const most = largest(total, c), peak = floor - Math.min(most / scale, 1) * room;
      pen.fillStyle = color('--muted');
      if (run.frames > columns && peak < base - 1) pen.fillRect(left + c, peak, 1, 1);
      if (most > scale) pen.fillRect(left + c, time_top, 1, 3);
    }

    // Where the frames came from: of a column's the last in the order.
    for (let c = 0; c < columns; c++) {
      pen.fillStyle = origin_colors[largest(n.origin, c)];
      pen.fillRect(left + c, depth_floor + 2, 1, between - 4);
    }

    // Marks above, the grave ones last and tallest.
    for (const [name, tall] of [['untracked', 5], ['returned', 5], ['behind', 5], ['held', 9], ['stuck', 11], ['wrong', 11]]) {
      pen.fillStyle = mark_colors[name];
      for (let f = 0; f <= last; f++) if (n.marks[f] & marks[name]) pen.fillRect(x_of(f) - 1, top - 2 - tall, 2, tall);
    }

    pen.fillStyle = color('--muted');
    pen.textAlign = 'right';
    pen.textBaseline = 'middle';
    pen.fillText(deepest > 0 ? (1e3 * deepest).toFixed(deepest < .00995 ? 1 : 0) : '0', left - 6, top + 6);
    pen.fillText('mm in', left - 6, top + 19);
    const top_time = 1e3 * scale;
    pen.fillText(top_time.toFixed(top_time < 1 ? 2 : top_time < 10 ? 1 : 0), left - 6, time_top + 6);
    pen.fillText('ms', left - 6, time_top + 19);
    pen.textAlign = 'center';
    const begin = n.t[0], span = Math.max(n.t[last] - begin, 1e-9), step = tick_step(span, Math.max(2, (width - left) / 90));
    for (let t = Math.ceil(begin / step) * step; t <= n.t[last] + 1e-9; t += step) {
      const x = left + (t - begin) / span * (width - left - 1), text = `${Number(t.toFixed(6))} s`;
      pen.fillRect(x, floor, 1, 3);
      pen.fillText(text, Math.min(Math.max(x, left + 8), width - pen.measureText(text).width / 2 - 1), floor + 10);
    }
  }
  const show = frame => { cursor.style.transform = `translateX(${x_of(frame) - .75}px)`; };

  box.onpointerdown = event => {
    box.setPointerCapture(event.pointerId);
    seek(frame_at(event.clientX - box.getBoundingClientRect().left));
  };
  box.onpointermove = event => {
    const x = event.clientX - box.getBoundingClientRect().left, f = frame_at(x);
    if (event.buttons) seek(f);
    const stages = run.stages.map((stage, k) => [stage, n[stage][f]]).filter(([, t]) => t > 0).map(([stage, t]) => `${stage} ${milliseconds(t)}`).join(', ');
    tip.textContent = `frame ${integer(n.number[f])}, ${seconds(n.t[f])}${run.fault(f) ? `: ${run.fault(f)}` : ''}\ntracked hand ${n.depth[f] > 0 ? `${millimetres(n.depth[f])} inside` : 'outside'}\n${milliseconds(total[f])}: ${stages}`;
    tip.hidden = false;
    tip.style.left = `${Math.max(0, Math.min(x + 12, width - tip.offsetWidth))}px`;
  };
  box.onpointerleave = () => { tip.hidden = true; };
  return {show, draw, set_theme(name) { theme = name; draw(); }};
}
