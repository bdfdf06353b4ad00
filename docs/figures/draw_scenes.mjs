// node docs/figures/draw_scenes.mjs [PROGRAM] [NAME...]: the pictures of docs/god-hand/scenes.md, and docs/replay.png.
//
// PROGRAM (./zwang) simulates each scene; the page of the run shows one moment of it in headless Chromium, and its view is kept as
// scenes/NAME.webp. "replay" is the whole page. With names, only these.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import {open_browser} from '../../tests/bench/report/chromium.mjs';

// What is simulated, for how long, which moment is shown [s], and from where: a camera of the page, or its place and aim [m].
const pictures = {
  replay: ['box --motion lift', 3, 2.5, '.55,-.45,.38,.1,.03,.22'],
  box: ['box --motion lift', 3, 2.5, '.55,-.45,.38,.1,.03,.22'],
  grasp: ['grasp --motion grasp', 2.5, 1.7, 'iso'],
  simple: ['simple --motion grasp', 2.5, 1.67, 'iso'],
  engine: ['engine --motion press', 1.5, 1.2, 'scene'],
  detailed: ['detailed --motion press', 1.5, 1.2, 'scene'],
  wall: ['wall --motion press', 1.5, 1.2, 'iso'],
  plate: ['plate --motion poke', 1.5, 1.2, 'iso'],
  pegs: ['pegs --motion press', 1.5, 1.2, 'iso'],
  holes: ['holes --motion poke', 1.5, 1.2, 'iso'],
  hole: ['hole --god peg --motion insert', 3, 1.5, '.2,.2,.14,0,0,.045'],
  lock: ['lock --god key --motion unlock', 5, 2.6, '.24,.1,.12,0,0,.02'],
};
const here = import.meta.dirname ?? path.dirname(new URL(import.meta.url).pathname);
const [program = './zwang', ...names] = process.argv.slice(2);
const runs = fs.mkdtempSync(`${os.tmpdir()}/zwang-scenes-`);
const browser = await open_browser();
try {
  for (const name of names.length > 0 ? names : Object.keys(pictures)) {
    const [what, seconds, moment, camera] = pictures[name], run = path.join(runs, name), whole = name === 'replay';
    execFileSync(program, ['simulate', ...what.split(' '), '--seconds', seconds, '--verify', '0', '--out', run], {stdio: ['ignore', 'ignore', 'inherit']});
    const page = await browser.open_page(path.join(run, 'replay.html'), {...whole ? {width: 1280, height: 800} : {width: 560, height: 360},
      hash: `frame=${Math.round(1000 * moment)}&cam=${camera}&theme=light`});
    await page.evaluate(`${whole} || document.head.append(Object.assign(document.createElement('style'),
      {textContent: '.panel, #dock { display: none !important } #stage { position: fixed; inset: 0; height: auto }'}))`);
    // The view has got its size by then; a camera that has a name looks from where that makes it look.
    await page.evaluate(`new Promise(done => setTimeout(done, 1000))`);
    await page.evaluate(`(${camera.includes(',')} || zwang_replay.set_camera('${camera}'), zwang_replay.world.draw(), 0)`);
    await page.evaluate(`new Promise(done => setTimeout(done, 1000))`);
    await page.screenshot(path.join(here, whole ? '../replay.png' : `scenes/${name}.webp`));
    await page.close();
    console.log(name);
  }
} finally {
  await browser.close();
  fs.rmSync(runs, {recursive: true, force: true});
}
