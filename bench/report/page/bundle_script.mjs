// node bundle_script.mjs SCRIPT OUT: a script with all that it imports, and the chart specs, as one file for Node.
import {buildSync} from 'esbuild';
import fs from 'node:fs';

const here = new URL('.', import.meta.url).pathname;
const charts = Object.fromEntries(fs.readdirSync(here + '../charts').sort()
  .map(file => [file.replace('.vl.json', ''), JSON.parse(fs.readFileSync(here + '../charts/' + file, 'utf8'))]));
const [script, out] = process.argv.slice(2);
buildSync({
  entryPoints: [here + script], outfile: out, bundle: true, minify: true, format: 'esm', platform: 'node', target: 'node18',
  charset: 'utf8', legalComments: 'eof', define: {CHARTS: JSON.stringify(charts), STABILITY: fs.readFileSync(here + 'stability.json', 'utf8')}, logLevel: 'error',
});
