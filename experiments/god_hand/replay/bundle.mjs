// node bundle.mjs OUT NODE_MODULES: the replay page without its data: template, style, and the scripts with three.js as one.
import fs from 'node:fs';
import {createRequire} from 'node:module';

const node_modules = process.argv[3];
const {buildSync} = createRequire(node_modules + '/')('esbuild');
const here = new URL('.', import.meta.url).pathname;
const read = name => fs.readFileSync(here + name, 'utf8');
const {outputFiles: [script]} = buildSync({
  entryPoints: [here + 'app.mjs'], bundle: true, minify: true, format: 'iife', target: 'es2022', charset: 'utf8',
  legalComments: 'eof', write: false, nodePaths: [node_modules],
  // Begins once the page is drawn, which says that it loads.
  banner: {js: "addEventListener('load', () => setTimeout(() => {"}, footer: {js: '}, 60));'},
  alias: {meshopt_decoder: node_modules + '/meshoptimizer/meshopt_decoder_reference.js'},
});
// A script element's text ends at "</script"; "<!--" and "<script" change how it is read. All three occur in strings only.
const code = script.text.replace(/<\/(script)/gi, '<\\/$1').replace(/<!--/g, '\\x3c!--').replace(/<(script)/gi, '\\x3c$1');

let page = read('replay.html');
for (const [slot, text] of Object.entries({'/*{replay.css}*/': read('replay.css'), '/*{app.mjs}*/': code})) {
  if (!page.includes(slot)) throw new Error(`the template has no ${slot}`);
  page = page.replace(slot, () => text);
}
fs.writeFileSync(process.argv[2], page);
