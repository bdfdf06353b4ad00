// The numbers of the frame that is shown.
import {marks} from './data.mjs';
import {mark_colors, origins, stage_colors} from './palette.mjs';
import {element, integer, millimetres, milliseconds, tiny} from './words.mjs';

const $ = id => document.getElementById(id);

export function make_panel(run) {
  const n = run.numbers;
  const rate = Math.round(1 / run.dt);
  document.title = `zwang: ${run.motion} in ${run.scene}`;
  $('title').textContent = `${run.motion} · ${run.scene}`;
  $('subtitle').textContent = `${run.solver} at ${integer(rate)} Hz`;
  const shown = run.frames < run.total ? `${integer(run.frames)} of ${integer(run.total)} frames are shown: of neighbours the most telling, a wrong, stuck or held one first.` : `All ${integer(run.total)} frames are shown.`;
  const full = run.surroundings.meshes.reduce((sum, mesh) => sum + mesh.full, 0), drawn = run.surroundings.meshes.reduce((sum, mesh) => sum + mesh.indices / 3, 0);
  const meshes = full === 0 ? [] : [drawn < full ? `Meshes of ${integer(full)} triangles are drawn with ${integer(drawn)}; the simulation met all of them.` : `Meshes of ${integer(full)} triangles, all drawn.`];
  $('lines').append(...[...run.lines, shown, ...meshes].map(line => element('p', {textContent: line})),
    element('p', {}, element('code', {textContent: run.command})), element('p', {textContent: `${run.conditions}; begun ${run.started}`}));

  // Each row: what it is called, what it says, and its tone.
  const rows = [
    ['contacts', f => n.raw[f] > 0 ? `${integer(n.raw[f])} → ${integer(n.kept[f])}` : '0', () => '', 'found → kept as rows'],
    ['smallest gap', f => n.gap[f] >= .05 ? '> 50 mm' : millimetres(n.gap[f]), f => n.gap[f] < 0 ? 'bad' : '', 'god objects to anything; below 0: penetration'],
    ['tracked hand inside', f => millimetres(n.depth[f]), f => n.depth[f] > 0 ? 'ghost' : '', 'the deepest body of the tracked hand'],
    ['step', f => origins[n.origin[f]], () => '', 'where the frame came from: free, the constrained step, damped, bounded, relaxed or held'],
    ['apart from it', f => millimetres(n.dist[f]), () => '', 'largest distance of a god object to its target'],
    ['force shown', f => `${n.force[f].toFixed(2)} N`, () => '', 'what a haptic device would show at the first palm'],
    null,
    ['joints', f => tiny(n.joint[f], 'm'), f => n.joint[f] > 1e-9 ? 'bad' : '', 'largest gap of a joint'],
    ['limits', f => n.limit[f] > 1e-9 ? tiny(n.limit[f], 'rad') : 'kept', f => n.limit[f] > 1e-9 ? 'bad' : 'good', 'of the joint angles'],
    ['rows', f => integer(n.rows[f]), () => '', 'joints, limits and contacts of the last solve'],
    ['answer', f => n.marks[f] & marks.wrong && run.fault(f) === 'wrong answer' ? 'WRONG' : run.verified(f), f => run.verified(f) === 'solved' ? 'good' : run.verified(f) === 'wrong' ? 'bad' : '', 'as the referee finds it'],
  ];
  const cells = rows.map(row => {
    if (!row) return void $('numbers').append(element('hr'));
    const [name, , , title] = row, value = element('dd');
    $('numbers').append(element('dt', {textContent: name, title}), value);
    return value;
  });
  const parts = run.stages.map(stage => {
    const part = element('i');
    part.style.background = stage_colors[stage];
    $('split').append(part);
    return part;
  });

  return function show(f) {
    rows.forEach((row, i) => {
      if (!row) return;
      cells[i].textContent = row[1](f);
      cells[i].className = row[2](f);
    });
    const times = run.stages.map(stage => n[stage][f]), total = times.reduce((a, b) => a + b, 0);
    $('step').textContent = milliseconds(total);
    parts.forEach((part, k) => { part.style.width = `${total > 0 ? 100 * Math.max(times[k], 0) / total : 0}%`; });
    $('split').title = run.stages.map((stage, k) => `${stage} ${milliseconds(times[k])}`).join('\n');
    $('split').setAttribute('aria-label', $('split').title.replaceAll('\n', ', '));

    const bits = n.marks[f], badges = [];
    const badge = (text, color) => badges.push(Object.assign(element('span', {className: color ? 'badge' : 'badge calm', textContent: text}), color ? {style: `background:${color}`} : {}));
    if (bits & marks.wrong) badge(run.fault(f), mark_colors.wrong);
    if (bits & marks.stuck) badge('stuck', mark_colors.stuck);
    if (bits & marks.held) badge('held: the hand kept its pose', mark_colors.held);
    if (bits & marks.untracked) badge('no tracking', mark_colors.untracked);
    if (bits & marks.behind) badge('target beyond a thin part', mark_colors.behind);
    if (bits & marks.returned) badge('object put back', mark_colors.returned);
    if (badges.length === 0) badge(n.gap[f] <= 5e-4 ? 'touching, nothing penetrates' : 'free');
    $('badges').replaceChildren(...badges);
  };
}
