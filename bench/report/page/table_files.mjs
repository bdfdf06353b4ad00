// A table of a report as a file for a paper: comma-separated values, or LaTeX for an article of one column or of two.

const field = text => /[,"\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
// As C's %.9g, which rounds a tie to the even digit.
function plain(value) {
  if (value === 0) return '0';
  const [exact, exponent] = Math.abs(value).toExponential(100).replace('.', '').split('e'), kept = exact.slice(0, 9), rest = exact.slice(9);
  const half = '5'.padEnd(rest.length, '0'), up = rest > half || (rest === half && kept % 2);
  const rounded = String(Number(kept) + (up ? 1 : 0)), power = Number(exponent) + rounded.length - 9, digits = rounded.replace(/0+$/, '');
  const sign = value < 0 ? '-' : '', point = at => at < digits.length ? `${digits.slice(0, at)}.${digits.slice(at)}` : digits.padEnd(at, '0');
  if (power < -4 || power > 8) return `${sign}${point(1)}e${power < 0 ? '-' : '+'}${String(Math.abs(power)).padStart(2, '0')}`;
  return sign + (power < 0 ? `0.${'0'.repeat(-power - 1)}${digits}` : point(power + 1));
}
// What a text says of its number besides: that it is a bound, or of how many problems it is. It stands in a column of its own behind the
// numbers: a mean over the five problems that a solver reached is no mean over all.
const aside = ({text, value}) => Number.isFinite(value) ? /^[<>]=?(?= )|\bon \d+ of \d+$|(?<=^\d+ )of \d+/.exec(text)?.[0] ?? '' : '';
export function to_csv(table) {
  const lines = [[], ...table.rows.map(() => [])];
  table.columns.forEach(({name, numeric}, c) => {
    const cells = table.rows.map(row => row.cells[c]), asides = cells.map(cell => numeric ? aside(cell) : '');
    const columns = [[name, ...cells.map(cell => numeric && Number.isFinite(cell.value) ? plain(cell.value) : cell.text)]];
    if (asides.some(Boolean)) columns.push([`${name}: note`, ...asides]);
    for (const column of columns) column.forEach((text, line) => lines[line].push(field(text)));
  });
  return lines.map(fields => fields.join(',') + '\n').join('');
}

// Of LaTeX's article class at 10 pt [pt]: a column of two, the text in one; and our type, with what parts two columns.
const column_of_two = 229, whole_text = 345, type = 8, gap = 6;
const page_lines = 45;  // lines of our type, below a caption
const before_a_knob = /(,|:|\w\()(?=[a-z])/g;  // where a name may be broken
const sum = list => list.reduce((all, x) => all + x, 0), most_of = list => list.reduce((most, x) => Math.max(most, x), 0);  // of lists of any length

// Our texts are ASCII; what TeX reads as commands is escaped, the backslash first.
const tex_text = text => text.replace(/\\/g, '\\textbackslash ').replace(/[_%&#${}]/g, '\\$&').replace(/\^(-?[0-9]+)/g, '$$^{$1}$$')
  .replace(/\^(?!\{)/g, '\\^{}').replace(/\|/g, '$$|$$').replace(/<=/g, '$$\\le$$').replace(/[<>]/g, '$$$&$$').replace(/ us\b/g, ' $$\\mu$$s')
  .replace(before_a_knob, '$&\\allowbreak ');

// In Computer Modern, seldom less than it is [pt].
const width = text => sum([...text].map(c => type * (' .,:;\'|()[]-_!Ifijlrt'.includes(c) ? 0.41 : /[A-Zmw%=+<>]/.test(c) ? 0.85 : /\d/.test(c) ? 0.54 : 0.59)));

// Columns that stand side by side. The widest give way until all have room, at most to their longest words.
function side_by_side(columns, widest) {
  const whole = widths => sum(widths) + gap * widths.length;
  let widths = columns.map(c => widest[c].text);
  const breaks = whole(widths) > whole_text;
  for (let most = most_of(widths); whole(widths) > whole_text && most > 0; --most)
    widths = columns.map(c => Math.max(widest[c].word, Math.min(widest[c].text, most)));
  return {columns, widths, breaks, whole: whole(widths)};
}

// One block where the words of all columns have room; else several, each with what names the rows: the columns before
// the first numbers.
function blocks_of(columns, widest) {
  const names = columns.map((_, c) => c).slice(0, columns.findIndex(column => column.numeric));
  if (!columns.some(column => column.numeric)) names.splice(0, Infinity, 0);
  const blocks = [];
  let chosen = [...names];
  for (let c = names.length; c < columns.length; ++c) {
    chosen.push(c);
    if (side_by_side(chosen, widest).whole <= whole_text || chosen.length === names.length + 1) continue;
    chosen.pop();
    blocks.push(side_by_side(chosen, widest));
    chosen = [...names, c];
  }
  return [...blocks, side_by_side(chosen, widest)];
}

export function to_tex(table) {
  const widest = table.columns.map((column, c) => {
    const texts = [column.name, ...table.rows.map(row => row.cells[c].text)];
    return {text: most_of(texts.map(width)), word: most_of(texts.flatMap(text => text.replace(before_a_knob, '$& ').split(' ')).map(width))};
  });
  const blocks = blocks_of(table.columns, widest);
  const lines = sum(blocks.flatMap(block => table.rows.map(row =>
    Math.max(1, ...block.columns.map((c, i) => Math.ceil(width(row.cells[c].text) / (block.widths[i] + 1)))))));
  const is_long = lines > page_lines, wide = most_of(blocks.map(block => block.whole)) > column_of_two;
  const environment = is_long ? 'longtable' : wide ? 'table*' : 'table';
  const caption = `\\caption{${tex_text(table.note)}}\n\\label{tab:zwang-${table.id}}`;
  const small = `\\fontsize{${type}}{${1.2 * type}}\\selectfont\n\\setlength{\\tabcolsep}{${gap / 2}pt}\n`;
  const line_of = (block, text_at) => block.columns.map(c => tex_text(text_at(c))).join(' & ') + ' \\\\\n';
  const specification = block => block.columns.map((c, i) => {
    const {numeric} = table.columns[c];
    return !block.breaks ? numeric ? 'r' : 'l' : `>{\\ragged${numeric ? 'left' : 'right'}\\arraybackslash}p{${Math.floor(block.widths[i])}pt}`;
  }).join('');

  let out = `% \\usepackage{array,booktabs${is_long ? ',longtable}; after \\onecolumn' : '}'}\n`;
  out += is_long ? `\\begingroup\n${small}\\setlength{\\LTcapwidth}{\\textwidth}\n` : `\\begin{${environment}}\n\\centering\n${caption}\n\\smallskip\n${small}`;
  blocks.forEach((block, k) => {
    const head = `\\toprule\n${line_of(block, c => table.columns[c].name)}\\midrule\n`;
    if (k > 0) out += is_long ? '\\addtocounter{table}{-1}\n' : '\n\\medskip\n';
    out += `\\begin{${is_long ? 'longtable' : 'tabular'}}{${specification(block)}}\n`;
    if (is_long && k === 0) out += `${caption}\\\\\n${head}\\endfirsthead\n`;
    out += head + (is_long ? '\\endhead\n\\bottomrule\n\\endfoot\n' : '');
    for (const row of table.rows) out += line_of(block, c => row.cells[c].text);
    out += is_long ? '\\end{longtable}\n' : '\\bottomrule\n\\end{tabular}\n';
  });
  return out + (is_long ? '\\endgroup\n' : `\\end{${environment}}\n`);
}
