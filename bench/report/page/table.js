// Tables: sorted by a click on a column's head, long ones folded, the commands that repeat a row's run below it.
(() => {
  'use strict';
  const {styles, superscript} = zwang_charts;

  const element = (tag, properties = {}, ...children) => {
    const node = Object.assign(document.createElement(tag), properties);
    node.append(...children);
    return node;
  };

  // ASCII of the data, set for readers: 3.2e-9, 2^-27, 18 us, 5.8x.
  const typeset = text => text
    .replace(/\b(\d+(?:\.\d+)?)e(-?\d+)\b/g, (_, m, e) => `${m === '1' ? '' : m + '·'}10${superscript(e)}`)
    .replace(/\^(-?(?:\d+|[kn]\b))/g, (_, e) => superscript(e).replace('k', 'ᵏ').replace('n', 'ⁿ'))
    .replace(/(\d) us\b/g, '$1 µs')
    .replace(/(\d)x\b/g, '$1×')
    .replace(/<= /g, '≤ ');

  const short_table = 12;
  const sorting = {};
  const unfolded = new Set();
  function table(holder, data, state) {
    const id = holder.dataset.table;
    const content = data.tables[id];
    holder.replaceChildren();
    if (content.note) holder.append(element('p', {className: content.rows.length ? 'note' : 'reason', textContent: typeset(content.note)}));
    const group = holder.dataset.group ? state[holder.dataset.group] || 'all' : '';
    const has_group = group && content.rows.some(row => row.group === group);
    let shown = content.rows.filter(row => (!row.solver || state.listed.has(row.solver)) && (!has_group || row.group === group));
    if (!shown.length) {
      if (content.rows.length) holder.append(element('p', {className: 'reason', textContent: 'Nothing to show for the solvers and the family chosen.'}));
      return;
    }
    const used = content.columns.map((_, i) => shown.some(row => row.cells[i]?.text));
    const sort = sorting[id];
    if (sort) {
      const key = row => row.cells[sort.column].value ?? row.cells[sort.column].text;
      const compare = (a, b) => typeof a === typeof b ? (a < b ? -1 : a > b ? 1 : 0) : typeof a === 'number' ? -1 : 1;
      shown = [...shown].sort((a, b) => sort.sign * compare(key(a), key(b)));
    }
    const head = element('tr');
    content.columns.forEach((column, i) => {
      if (!used[i]) return;
      const cell = element('th', {textContent: typeset(column.name), className: column.numeric ? 'number' : '', scope: 'col'});
      if (sort?.column === i) cell.ariaSort = sort.sign > 0 ? 'ascending' : 'descending';
      cell.onclick = () => {
        sorting[id] = {column: i, sign: sort?.column === i ? -sort.sign : 1};
        table(holder, data, state);
      };
      head.append(cell);
    });
    const with_commands = holder.dataset.commands === 'shown';
    const body = element('tbody');
    const color = Object.fromEntries(styles(data.solvers, state.theme).map(s => [s.name, s.color]));
    const folded = holder.dataset.fold !== 'never' && shown.length > short_table + 3 && !unfolded.has(id);
    for (const row of folded ? shown.slice(0, short_table) : shown) {
      const line = element('tr', {className: with_commands && row.command ? 'with-command' : ''});
      row.cells.forEach((cell, i) => {
        if (!used[i]) return;
        const verbatim = id === 'conditions' || cell.text === row.solver || content.columns[i].name === 'problem';
        const td = element('td', {className: `${content.columns[i].numeric ? 'number' : ''} ${cell.tone ?? ''}`}, verbatim ? cell.text : typeset(cell.text));
        if (cell.text === row.solver && color[row.solver]) {
          const dot = element('span', {className: 'swatch'});
          dot.style.background = color[row.solver];
          td.prepend(dot);
          td.classList.add('solver');
        }
        line.append(td);
      });
      if (row.command && !with_commands) line.title = row.command;
      body.append(line);
      if (row.command && with_commands)
        body.append(element('tr', {className: 'command'}, element('td', {colSpan: used.filter(Boolean).length}, element('code', {textContent: row.command}))));
    }
    holder.append(element('div', {className: 'scroll'}, element('table', {}, element('thead', {}, head), body)));
    if (folded) holder.append(element('button', {textContent: `show all ${shown.length} rows`, onclick: () => { unfolded.add(id); table(holder, data, state); }}));
  }

  globalThis.zwang_tables = {element, typeset, table};
})();
