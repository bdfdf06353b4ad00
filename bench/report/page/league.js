// The league: tables of what each solver and version made of each pack.
(() => {
  'use strict';
  const {scientific, duration} = zwang_charts;
  const {element, table} = zwang_tables;
  const {packs, entries} = JSON.parse(document.getElementById('data').textContent);
  const pack_names = Object.keys(packs);

  const is_right = row => row !== null && row[0];
  const median = list => list.length ? [...list].sort((a, b) => a - b)[list.length >> 1] : null;

  // The problems of a pack that every solver with times of this machine has right, and a time for.
  const timed = (pack, machine) => {
    const rivals = machine ? entries.filter(e => e.packs[pack]?.machine === machine && e.packs[pack].rows.some(row => row && row[3] !== null)) : [];
    return rivals.length < 2 ? [] : packs[pack].map((_, k) => k).filter(k => rivals.every(e => is_right(e.packs[pack].rows[k]) && e.packs[pack].rows[k][3] !== null));
  };

  function measured(entry, pack) {
    const judged = entry.packs[pack];
    if (!judged) return null;
    const right = judged.rows.filter(is_right), common = timed(pack, judged.machine);
    return {
      right: right.length, all: judged.rows.length, others: judged.rows.filter(row => row === null).length, lies: judged.rows.filter(row => row?.[1]).length,
      error: median(right.map(row => row[2]).filter(error => error !== null)),
      time: judged.rows.some(row => row && row[3] !== null) && common.length ? common.reduce((sum, k) => sum + judged.rows[k][3], 0) : null, common: common.length,
    };
  }
  const cell = m => m === null ? {text: '–', value: -1} : {
    text: [`${m.right} of ${m.all} right`, `${m.lies} false`, m.others ? `${m.others} by another solver` : '', m.error === null ? '' : `error ${scientific(m.error)}`,
           m.time === null ? '' : `${duration(m.time)} for ${m.common}`].filter(Boolean).join(', '),
    value: m.right / m.all, tone: m.lies ? 'bad' : m.right === m.all ? 'good' : '',
  };

  const column = (name, numeric = false) => ({name, numeric});
  const standings = {
    columns: [column('solver'), column('version'), ...pack_names.map(name => column(name))],
    rows: entries.map(e => ({solver: e.solver, group: '', cells: [{text: e.solver}, {text: e.version}, ...pack_names.map(pack => cell(measured(e, pack)))]})),
  };

  const signed = (after, before) => after === before ? '' : ` (${after > before ? '+' : '−'}${Math.abs(after - before)})`;
  const history = {
    note: 'No solver has two versions here yet.',
    columns: [column('solver'), column('pack'), column('version'), column('right', true), column('false', true), column('error', true)],
    rows: [],
  };
  for (const solver of new Set(entries.map(e => e.solver)))
    for (const pack of pack_names) {
      const versions = entries.filter(e => e.solver === solver && e.packs[pack]);
      if (versions.length < 2) continue;
      let before = null;
      for (const e of versions) {
        const m = measured(e, pack), last = before ?? m;
        history.rows.push({solver, group: '', cells: [
          {text: solver}, {text: pack}, {text: e.version},
          {text: `${m.right}${signed(m.right, last.right)}`, value: m.right, tone: m.right < last.right ? 'bad' : m.right > last.right ? 'good' : ''},
          {text: `${m.lies}${signed(m.lies, last.lies)}`, value: m.lies, tone: m.lies > last.lies ? 'bad' : m.lies < last.lies ? 'good' : ''},
          {text: m.error === null ? '' : scientific(m.error), value: m.error ?? undefined}]});
        before = m;
      }
    }
  if (history.rows.length) history.note = 'Below each other the versions of one solver; in brackets the change from the one before.';

  const count = (n, what) => `${n} ${n === 1 ? what : what.replace(/y$/, 'ie') + 's'}`;
  const solvers = [...new Set(entries.map(e => e.solver))];
  document.getElementById('headline').append(element('p', {
    textContent: `${count(entries.length, 'entry')} of ${count(solvers.length, 'solver')} on ${count(pack_names.length, 'pack')}: ` +
      pack_names.map(name => `${name} (${count(packs[name].length, 'problem')})`).join(', ') + '.'}));
  for (const e of entries) {
    const head = element('h3', {}, `${e.solver} ${e.version} `);
    if (e.url) head.append(element('a', {href: e.url, rel: 'nofollow noreferrer', textContent: e.url, className: 'note'}));
    document.getElementById('entries').append(head, element('p', {className: e.reply ? '' : 'note', textContent: e.reply || 'No reply.'}));
  }

  function set_theme(theme) {
    document.documentElement.dataset.theme = theme;
    document.getElementById('theme').textContent = theme === 'dark' ? 'light' : 'dark';
    const data = {tables: {standings, history}, solvers: solvers.map(name => ({name, style: name}))};
    for (const holder of document.querySelectorAll('[data-table]')) table(holder, data, {listed: new Set(solvers), theme});
  }
  document.getElementById('theme').onclick = () => set_theme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark');
  set_theme(matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
})();
