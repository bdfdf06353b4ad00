// The replay of a simulated run: wiring of view, numbers, timeline, transport, keys and the state in the URL.
import {marks, read_run} from './data.mjs';
import {contact_colors, mark_colors, origin_colors, origins, stage_colors, themes} from './palette.mjs';
import {make_panel} from './panel.mjs';
import {make_timeline} from './timeline.mjs';
import {css, element, integer, seconds} from './words.mjs';
import {cameras, layers, make_world} from './world.mjs';

const $ = id => document.getElementById(id);
const errors = [];
addEventListener('error', event => errors.push(event.message));
const trouble = text => { $('trouble').textContent = text; $('trouble').hidden = false; };

const run = read_run(), times = run.numbers.t, last = run.frames - 1;
const grave = marks.wrong | marks.stuck | marks.held;
const narrow = matchMedia('(max-width: 720px), (max-height: 560px)').matches;
const speeds = [.02, .05, .1, .25, .5, 1, 2, 4];
const icons = {play: 'M6 3.5v13l10.5-6.5z', pause: 'M5 4h3.6v12H5zm6.4 0H15v12h-3.6z'};
const state = {frame: 0, playing: false, speed: 1, camera: 'iso', theme: 'light'};

let world;
try {
  world = make_world($('view'), run, what => {
    if (what !== 'camera' || state.camera === 'free') return;
    state.camera = 'free';
    press_camera();
  });
} catch (error) {
  trouble(`The 3D view needs WebGL 2, which this browser does not offer (${error.message}). The numbers and the timeline below work.`);
  world = {show() {}, draw() {}, set_layer() {}, set_theme() {}, aim() {}, set_view() {}, view: () => [], layers: {}, rendered: 0};
}
const show_numbers = make_panel(run);
const timeline = make_timeline(run, $('timeline'), $('chart'), $('cursor'), $('tip'), frame => { play(false); show(frame); });

function show(frame) {
  state.frame = Math.max(0, Math.min(last, Math.round(frame)));
  world.show(state.frame);
  show_numbers(state.frame);
  timeline.show(state.frame);
  $('scrub').value = state.frame;
  $('scrub').style.setProperty('--done', `${last > 0 ? 100 * state.frame / last : 0}%`);
  $('clock').replaceChildren(seconds(times[state.frame]), element('small', {textContent: `frame ${integer(run.numbers.number[state.frame])} of ${integer(run.total)}`}));
  if (!state.playing) remember();
}

// Time runs as it did in the run; frames that come too fast for the screen are passed over.
let clock = 0, before = 0;
function play(on) {
  if (on === state.playing) return;
  state.playing = on;
  $('play').innerHTML = `<svg viewBox="0 0 20 20"><path d="${on ? icons.pause : icons.play}"/></svg>`;
  $('play').title = on ? 'Pause (space)' : 'Play (space)';
  $('play').setAttribute('aria-label', on ? 'Pause' : 'Play');
  if (!on) return remember();
  if (state.frame >= last) show(0);
  clock = times[state.frame];
  before = performance.now();
  requestAnimationFrame(tick);
}
function tick(now) {
  if (!state.playing) return;
  clock += Math.max(0, Math.min(now - before, 250)) / 1e3 * state.speed;
  before = now;
  let frame = state.frame;
  while (frame < last && times[frame + 1] <= clock) ++frame;
  if (frame !== state.frame) show(frame);
  if (frame >= last) return play(false);
  requestAnimationFrame(tick);
}
function step(by) {
  play(false);
  show(state.frame + by);
}
function next_wrong() {
  play(false);
  for (let k = 1; k <= run.frames; k++) {
    const frame = (state.frame + k) % run.frames;
    if (run.numbers.marks[frame] & grave) return show(frame);
  }
}

// State in the URL: a link to this moment, seen like this. Not while playing.
let remembering = 0;
function remember() {
  clearTimeout(remembering);
  remembering = setTimeout(() => {
    const parts = [`frame=${run.numbers.number[state.frame]}`, `cam=${state.camera === 'free' ? world.view().map(x => x.toFixed(4)).join(',') : state.camera}`, `theme=${state.theme}`];
    const off = Object.entries(world.layers).filter(([name, on]) => on !== defaults[name]).map(([name]) => name);
    if (off.length > 0) parts.push(`not=${off.join(',')}`);
    if (state.speed !== 1) parts.push(`speed=${state.speed}`);
    history.replaceState(null, '', `#${parts.join('&')}`);
  }, 120);
}
const defaults = {...world.layers};

function press_camera() {
  for (const button of $('cameras').children) button.setAttribute('aria-pressed', button.value === state.camera);
  remember();
}
function set_camera(name) {
  state.camera = name;
  world.aim(name);
  press_camera();
}
function set_layer(name, on) {
  world.set_layer(name, on);
  const box = document.querySelector(`#toggles input[value=${name}]`);
  if (box) box.checked = on;
  remember();
}
function set_speed(speed) {
  state.speed = speed;
  $('speed').value = speed;
  remember();
}
function set_theme(name) {
  state.theme = name;
  document.documentElement.dataset.theme = name;
  $('theme').textContent = name === 'dark' ? 'light' : 'dark';
  $('theme').title = `Change to the ${name === 'dark' ? 'light' : 'dark'} theme (T)`;
  world.set_theme(name);
  timeline.set_theme(name);
  draw_legend();
  remember();
}
function draw_legend() {
  const theme = themes[state.theme];
  const item = (text, color, kind = '') => {
    const dot = element('i', {className: kind});
    dot.style.background = dot.style.borderColor = css(color);
    return element('span', {}, dot, text);
  };
  const any = bit => run.numbers.marks.some(bits => bits & bit);
  $('legend').replaceChildren(
    ...run.hands.map((hand, h) => item(run.hands.length > 1 ? `${hand.left ? 'left' : 'right'} god hand` : `god ${hand.name}`, theme.hands[h % 2][0])),
    item(`tracked ${run.hands[0].name}`, theme.ghost, 'ring'), item('pressing', theme.touch[0]),
    ...run.loose > 0 ? [item('loose object', theme.loose[0])] : [],
    item('contact that pushes', contact_colors.push, 'bar'), item('contact at rest', contact_colors.near, 'bar'),
    ...any(marks.wrong) ? [item('wrong', mark_colors.wrong, 'bar')] : [], ...any(marks.held) ? [item('held', mark_colors.held, 'bar')] : []);
  const came = new Set(run.numbers.origin);
  $('legend').append(...origins.map((name, k) => [name, k]).filter(([, k]) => k > 0 && came.has(k)).map(([name, k]) => item(`step ${name}`, origin_colors[k], 'bar')));
  $('hint').replaceChildren(...run.stages.filter(stage => run.numbers[stage].some(t => t > 0)).map(stage => {
    const dot = element('i');
    dot.style.cssText = `display:inline-block;width:9px;height:9px;border-radius:2px;margin:0 5px 0 12px;background:${stage_colors[stage]}`;
    return element('span', {}, dot, stage);
  }));
}

const keys = {
  ' ': ['space', 'play or pause', () => play(!state.playing)],
  ArrowLeft: ['← →', 'one frame; with shift ten', event => step(event.shiftKey ? -10 : -1)],
  ArrowRight: ['', '', event => step(event.shiftKey ? 10 : 1)],
  Home: ['Home End', 'first, last frame', () => step(-run.frames)],
  End: ['', '', () => step(run.frames)],
  n: ['N', 'next wrong, stuck or held frame', next_wrong],
  '[': ['[ ]', 'slower, faster', () => set_speed(speeds[Math.max(0, speeds.indexOf(state.speed) - 1)])],
  ']': ['', '', () => set_speed(speeds[Math.min(speeds.length - 1, speeds.indexOf(state.speed) + 1)])],
  g: ['G', 'tracked hand', () => set_layer('ghost', !world.layers.ghost)],
  h: ['H', 'god hand', () => set_layer('hand', !world.layers.hand)],
  c: ['C', 'contacts', () => set_layer('contacts', !world.layers.contacts)],
  o: ['O', 'objects', () => set_layer('objects', !world.layers.objects)],
  x: ['X', 'see through the objects', () => set_layer('xray', !world.layers.xray)],
  f: ['F', 'follow the hand', () => set_layer('follow', !world.layers.follow)],
  t: ['T', 'light or dark', () => set_theme(state.theme === 'dark' ? 'light' : 'dark')],
  '?': ['?', 'these keys', () => { $('keys').hidden = !$('keys').hidden; }],
};
cameras.forEach((name, i) => { keys[i + 1] = [i === 0 ? `1–${cameras.length}` : '', i === 0 ? 'cameras' : '', () => set_camera(name)]; });
const letters = {ghost: 'G', hand: 'H', contacts: 'C', objects: 'O', xray: 'X', follow: 'F'};

$('cameras').append(...cameras.map((name, i) => element('button', {type: 'button', value: name, textContent: name, title: `${name} (${i + 1})`, onclick: () => set_camera(name)})));
$('toggles').append(...Object.entries(layers).map(([name, text]) => element('label', {},
  element('input', {type: 'checkbox', value: name, checked: !!world.layers[name], onchange: event => set_layer(name, event.target.checked)}), text, element('kbd', {textContent: letters[name]}))));
$('keys').append(...Object.values(keys).filter(([name]) => name).flatMap(([name, text]) => [element('kbd', {textContent: name}), element('span', {textContent: text})]));
$('speed').append(...speeds.map(speed => element('option', {value: speed, textContent: `${speed}×`})));
$('speed').onchange = event => set_speed(Number(event.target.value));
$('play').onclick = () => play(!state.playing);
$('back').onclick = () => step(-1);
$('forth').onclick = () => step(1);
$('next').onclick = next_wrong;
$('theme').onclick = keys.t[2];
$('help').onclick = keys['?'][2];
$('scrub').max = last;
$('scrub').oninput = event => { play(false); show(Number(event.target.value)); };
addEventListener('keydown', event => {
  if (event.ctrlKey || event.metaKey || event.altKey || (event.target.tagName === 'SELECT' && event.key !== 'Escape')) return;
  if (event.key === 'Escape') { $('keys').hidden = true; return; }
  const key = keys[event.key] ?? keys[event.key.toLowerCase()];
  if (!key || (event.key === ' ' && ['BUTTON', 'SUMMARY'].includes(event.target.tagName) && event.target.id !== 'play')) return;
  event.preventDefault();
  key[2](event);
});
const count = run.numbers.marks.reduce((sum, bits) => sum + (bits & grave ? 1 : 0), 0);
$('next').replaceChildren(...count > 0 ? ['next', element('span', {className: 'far', textContent: ' wrong'}), ` (${integer(count)})`] : ['none', element('span', {className: 'far', textContent: ' wrong'})]);
$('next').disabled = count === 0;
$('next').classList.toggle('some', count > 0);
if (narrow) $('about').open = $('controls').open = false;
new ResizeObserver(() => { timeline.draw(); timeline.show(state.frame); }).observe($('timeline'));

const asked = Object.fromEntries(new URLSearchParams(location.hash.slice(1)));
state.playing = true;
play(false);
set_speed(speeds.includes(Number(asked.speed)) ? Number(asked.speed) : 1);
set_theme(['light', 'dark'].includes(asked.theme) ? asked.theme : matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
// A link opens at its moment. Else the page plays, from a moment before the hand first pushes something.
const {start, numbers: contact} = run.contacts;
const pushed = Math.max(0, times.findIndex((t, frame) => { for (let k = start[frame]; k < start[frame + 1]; k++) if (contact[8 * k + 7] > 1e-6) return true; return false; }));
const linked = asked.frame !== undefined, first = linked ? run.numbers.number.findIndex(n => n >= Number(asked.frame)) : times.findIndex(t => t >= times[pushed] - .4);
show(first < 0 ? last : first);
for (const name of (asked.not ?? '').split(',')) if (name in defaults) set_layer(name, !defaults[name]);
const view = (asked.cam ?? '').split(',').map(Number);
if (view.length === 6 && view.every(Number.isFinite)) {
  state.camera = 'free';
  world.set_view(view);
  press_camera();
} else set_camera(cameras.includes(asked.cam) ? asked.cam : 'iso');

$('loading').remove();
play(!linked && !matchMedia('(prefers-reduced-motion: reduce)').matches);

globalThis.zwang_replay = {show, play, step, next_wrong, set_theme, set_camera, set_layer, set_speed, errors, pushed, frames: run.frames, marks: run.numbers.marks, world,
  get frame() { return state.frame; }, get playing() { return state.playing; }};
