// The protocol of docs/engines.md for engines of npm: one line of JSON in, one out. An adapter says what it is and makes worlds.
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join} from 'node:path';
import {createInterface} from 'node:readline';
import {pathToFileURL} from 'node:url';

// Engines that talk do so on stderr: stdout is the protocol's.
console.log = console.info = console.debug = console.warn = console.error;
const folder = join(process.env.ZWANG_ENGINES, 'node_modules');

// A package's module (or one file of it), a file of it, and its version.
export const library = (name, file = '') => import(pathToFileURL(createRequire(folder).resolve(join(folder, name, file))));
export const read = (name, file) => readFileSync(join(folder, name, file));
export const version = name => JSON.parse(read(name, 'package.json')).version;

export const minus = (a, b) => a.map((x, i) => x - b[i]);

// make(scene, tuned) gives {step(), states(), free()}: a state is [x, y, z, qw, qx, qy, qz, vx, vy, vz, wx, wy, wz].
export async function serve(hello, make) {
  const say = answer => process.stdout.write(`${JSON.stringify(answer)}\n`);
  let world;
  say({substeps: {default: 1, tuned: 1}, ...hello});
  for await (const line of createInterface({input: process.stdin})) {
    const ask = JSON.parse(line);
    try {
      if (ask.scene) {
        world?.free?.();
        world = null;
        world = make(ask.scene, ask.setting === 'tuned');
        say({states: world.states()});
      } else {
        for (let k = 0; k < ask.step; ++k) world.step();
        say({states: world.states()});
      }
    } catch (error) {
      say({error: `${error?.message ?? error}`});
    }
  }
}
