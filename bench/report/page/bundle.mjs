// node bundle.mjs OUT [collision]: template, style, scripts, chart specs and the Vega libraries as one page without its data.
import fs from 'node:fs';

const here = new URL('.', import.meta.url).pathname;
const read = name => fs.readFileSync(here + name, 'utf8');

// A script element's text ends at "</script"; "<!--" and "<script" change how it is read. In JavaScript all three occur
// only in strings, regular expressions and comments, where the escapes mean the same.
const inline = code => code
  .replace(/<\/(script)/gi, '<\\/$1').replace(/<!--/g, '\\x3c!--').replace(/<(script)/gi, '\\x3c$1')
  .replace(/\n?\/\/# sourceMappingURL=.*$/gm, '');

// The interpreter comes as a module only: its imports are found on the global `vega`.
const interpreter = read('node_modules/vega-interpreter/build/vega-interpreter.js')
  .replace(/import \{([^}]*)\} from 'vega-util';/, 'const {$1} = vega;')
  .replace(/export \{ (\w+) as expressionInterpreter \};/, 'globalThis.vega_interpreter = $1;');
if (/^(import|export) /m.test(interpreter)) throw new Error('vega-interpreter has an unknown module layout');

const specs = Object.fromEntries(fs.readdirSync(here + '../charts').sort()
  .map(file => [file.replace('.vl.json', ''), JSON.parse(read('../charts/' + file))]));
const libraries = ['vega/build/vega.min.js', 'vega-lite/build/vega-lite.min.js', 'vega-embed/build/vega-embed.min.js']
  .map(file => read('node_modules/' + file)).concat(`(() => {${interpreter}})();`);

const collision = process.argv[3] === 'collision';
const parts = collision ? {
  '/*{page.css}*/': read('page.css'),
  '<!--{libraries}-->': libraries.map(code => `<script>${inline(code)}</script>`).join('\n'),
  '/*{charts.js}*/': inline(read('charts.js')),
  '/*{collision.js}*/': inline(read('collision.js')),
} : {
  '/*{page.css}*/': read('page.css'),
  '<!--{libraries}-->': libraries.map(code => `<script>${inline(code)}</script>`).join('\n'),
  '/*{charts.js}*/': inline(read('charts.js')),
  '/*{labels.js}*/': inline(read('labels.js')),
  '/*{table.js}*/': inline(read('table.js')),
  '/*{page.js}*/': `const SPECS = ${inline(JSON.stringify(specs))};\n${inline(read('page.js'))}`,
};
let page = read(collision ? 'collision.html' : 'template.html');
for (const [slot, text] of Object.entries(parts)) {
  if (!page.includes(slot)) throw new Error(`the template has no ${slot}`);
  page = page.replace(slot, () => text);
}
fs.writeFileSync(process.argv[2], page);
