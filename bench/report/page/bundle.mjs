// node bundle.mjs OUT [collision|league]: body, style, scripts, chart specs and the Vega libraries as one page without its data.
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
const libraries = process.argv[3] === 'league' ? [] : ['vega/build/vega.min.js', 'vega-lite/build/vega-lite.min.js', 'vega-embed/build/vega-embed.min.js']
  .map(file => read('node_modules/' + file)).concat(`(() => {${interpreter}})();`);

const [body, title, scripts] = {
  collision: ['collision.html', 'zwang: collision suite', ['charts.js', 'collision.js']],
  league: ['league.html', 'zwang league', ['charts.js', 'table.js', 'league.js']],
}[process.argv[3]] ?? ['report.html', 'zwang report', ['charts.js', 'labels.js', 'table.js', 'page.js']];
const globals = {'charts.js': `const STABILITY = ${read('stability.json')};\n`, 'page.js': `const SPECS = ${JSON.stringify(specs)};\n`};
const script = name => inline((globals[name] ?? '') + read(name));

fs.writeFileSync(process.argv[2], `<!doctype html>
<html lang="en" data-theme="light">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; connect-src 'none'">
<link rel="icon" href="data:,">
<title>${title}</title>
<style>${read('page.css')}</style>
</head>
<body>
${read(body)}<script type="application/json" id="data">{"slot":"data"}</script>
${[...libraries.map(inline), ...scripts.map(script)].map(code => `<script>${code}</script>`).join('\n')}
</body>
</html>
`);
