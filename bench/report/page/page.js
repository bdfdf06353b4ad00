// The page: chips and selectors drive every chart and table; all data lies in the page itself.
(() => {
  'use strict';
  const {styles, register, spec, rows, words, take_class, all_rows, speed_families, measures, scientific} = zwang_charts;
  const {labelled} = zwang_labels;
  const {element, typeset, table} = zwang_tables;
  const data = JSON.parse(document.getElementById('data').textContent);
  const all = selector => [...document.querySelectorAll(selector)];
  const distinct = (name, field) => [...new Set(all_rows(data, name).map(row => row[field]))];
  register(vega);

  const everybody = data.solvers.map(s => s.name);
  const drawn_families = () => distinct('work-precision', 'family');
  const state = {
    listed: new Set(everybody),  // in tables and heat maps: all, until a reader chooses
    focus: '',
    theme: matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light',
    time: 'whole',
    level: 1e-6,
    measure: 'z_error',
  };
  // A paragraph on each stability family of the class.
  function stability() {
    const there = STABILITY.filter(of => data.families.includes(of.family));
    return {
      note: there.length ? '' : 'This run holds none of the stability families (docs/stability.md).',
      columns: ['family', 'knob', 'what it shows, and why methods fail there'].map(name => ({name, numeric: false})),
      rows: there.map(of => ({solver: '', group: '', cells: [of.family, of.knob, of.shows].map(text => ({text}))})),
    };
  }
  // The class of problems shown, and what is chosen within it. What a reader chose of the solvers stays.
  let names, chosen;
  function show_class(k) {
    const {solvers, shown} = take_class(data, k);
    names = solvers;
    data.tables.stability = stability();
    const middle = rows => (problems => problems[problems.length >> 1])([...new Set(rows.map(row => row.problem))]);
    const hands = names => names.find(name => /^hand\b/.test(name)) ?? names[0] ?? '';
    Object.assign(state, {
      problem_class: String(k),
      on: new Set(chosen?.some(name => solvers.includes(name)) ? chosen : shown),  // drawn in charts
      family: hands(drawn_families()),
      problem: '',
      group: '',
      trace: middle(all_rows(data, 'convergence').filter(row => row.family === hands(drawn_families()))) ?? distinct('convergence', 'problem')[0] ?? '',
      sweep: distinct('scaling', 'family')[0] ?? '',
      size_family: ['hand', 'H'].find(family => speed_families(data).includes(family)) ?? speed_families(data)[0] ?? '',
    });
    document.getElementById('ranking').textContent = typeset(data.classes[k].ranking);
    const undrawn = data.families.filter(family => !drawn_families().includes(family));
    document.getElementById('undrawn').textContent = drawn_families().length && undrawn.length
      ? `Not drawn: ${undrawn.join(', ')}. Where no z exists there is no error; the break points show who proves it and who lies.` : '';
    const left_out = names.filter(name => !state.on.has(name));
    document.getElementById('left-out').textContent = left_out.length && !chosen
      ? `Charts show the best ${state.on.size} of ${names.length} solvers; click ${left_out.slice(0, 4).join(', ')}${left_out.length > 4 ? ', ...' : ''} to add one. Tables show all.` : '';
    chips();
  }
  const views = {};
  const errors = [];

  // ---- charts ----

  function reason(name) {
    if (everybody.length === 0) return 'The run holds no results yet.';
    if (state.on.size === 0) return 'No solver is chosen in the row at the top.';
    const none = {
      'work-precision': 'No run of this family has an error to draw: its answers are proofs of infeasibility, or the solvers shown do not apply.',
      'families': 'No run has an error to draw.',
      'profile': 'No problem of this family has an achieved error that small: there is no reference, or every run missed it.',
      'convergence-iteration': 'The run holds no traces of this measure for the solvers shown; ./zwang bench --trace records them.',
      'scaling': 'No family of this run sweeps its size over three values or more, for the solvers shown.',
      'speed-ratios': 'No solver of this family has a time to compare.',
      'speed-exponents': 'No solver solved three sizes of hands, towers, walls (from 100 boxes) or random rows.',
      'sweep': 'This run holds none of the stability families (docs/stability.md).',
      'range-gap': 'No run shown reports a range gap together with a measured error.',
    };
    return none[name] ?? none[{'data-profile': 'profile', 'convergence-time': 'convergence-iteration'}[name]];
  }

  const columns_of = (width, cell) => Math.max(1, Math.floor((width - 40) / cell));
  function placeholders(name, holder) {
    const width = holder.clientWidth;
    return {
      FAMILIES: data.families,
      COLUMNS: name !== 'families' ? columns_of(width, 370) : columns_of(width, 228),
      FACET_WIDTH: Math.floor((width - 75) / columns_of(width, 228)) - 14,
      SWEEP_WIDTH: Math.min(230, width - 150),
      LIGHT: state.theme === 'light',
      ...words[name]?.(data, state),
    };
  }

  // The solvers that are drawn, the best of the class first.
  const best = () => [...new Set([...data.classes[state.problem_class].shown, ...names])].filter(name => state.on.has(name));

  // The rows of a chart, solvers' names among them, and the words of its spec.
  function prepared(name, holder) {
    const drawn = rows[name](data, state);
    if (drawn.length === 0) return {rows: drawn, words: {}, unnamed: []};
    const labels = labelled(name, drawn, {width: holder.clientWidth - 75, height: SPECS[name].height, best: best()});
    return {...labels, words: {...placeholders(name, holder), ...labels.words}};
  }
  const swatch = s => `<svg viewBox="0 0 30 12" aria-hidden="true"><line x1="0" x2="30" y1="6" y2="6" stroke="${s.color}" stroke-width="2" stroke-dasharray="${s.dash[1] ? s.dash.join(' ') : ''}"/>
    <path d="${s.shape}" transform="translate(15 6) scale(4.4)" fill="${s.color}"/></svg>`;
  // Below a chart: the solvers whose names found no place in it.
  const fill_key = (holder, unnamed) => holder.querySelector('.key').replaceChildren(
    ...styles(data.solvers, state.theme).filter(s => unnamed.includes(s.name)).map(s => element('span', {innerHTML: swatch(s)}, s.name)));

  const shown_words = {};
  async function draw(name) {
    const holder = document.querySelector(`[data-chart="${name}"]`);
    const drawn = prepared(name, holder);
    views[name]?.finalize();
    delete views[name];
    holder.replaceChildren();
    if (drawn.rows.length === 0) {
      holder.append(element('p', {className: 'reason', textContent: reason(name)}));
      return;
    }
    const plot = element('div', {className: 'plot'});
    const code = element('code');
    const button = (label, action) => element('button', {textContent: label, onclick: action});
    const zooms = ['work-precision', 'convergence-iteration', 'convergence-time', 'scaling'].includes(name);
    holder.append(plot, element('div', {className: 'key'}), element('div', {className: 'tools'}, button('SVG', () => save(name, 'svg')), button('PNG', () => save(name, 'png')),
      ...(zooms ? ['drag to pan, Alt+wheel to zoom, double-click to reset'] : []), code));
    const options = {theme: state.theme, words: drawn.words, width: 'container', plot: {width: holder.clientWidth - 75, height: SPECS[name].height ?? 200}};
    fill_key(holder, drawn.unnamed);
    shown_words[name] = JSON.stringify(drawn.words);
    const result = await vegaEmbed(plot, spec(SPECS[name], drawn.rows, data.solvers, options),
      {mode: 'vega-lite', actions: false, renderer: 'canvas', ast: true, expr: vega_interpreter, logLevel: vega.Error, tooltip: {theme: state.theme}});
    const view = views[name] = result.view;
    view.signal('focus', state.focus);
    let last = '';
    const follow = (_, value) => {
      const solver = value?.solver?.[0] ?? '';
      if (solver !== last) set_focus(last = solver);
    };
    try { view.addSignalListener('near', follow); } catch { /* charts without a nearest point have no such signal */ }
    view.addEventListener('click', (_, item) => {
      const datum = item?.datum?.datum ?? item?.datum;
      if (datum?.replay) code.replaceChildren(datum.replay, ...(datum.file ? [' ', element('a', {href: datum.file, textContent: datum.file})] : []));
    });
    await view.runAsync();
  }

  // New rows into a drawn chart; drawn anew where its words change or it was empty.
  async function update(name) {
    const holder = document.querySelector(`[data-chart="${name}"]`);
    if (!holder?.dataset.seen) return;
    const drawn = prepared(name, holder);
    if (!views[name] || drawn.rows.length === 0 || shown_words[name] !== JSON.stringify(drawn.words)) return draw(name);
    fill_key(holder, drawn.unnamed);
    await views[name].change('rows', vega.changeset().remove(() => true).insert(drawn.rows)).runAsync();
  }

  async function save(name, format) {
    const url = format === 'svg' ? URL.createObjectURL(new Blob([await views[name].toSVG()], {type: 'image/svg+xml'}))
                                 : await views[name].toImageURL('png', 2);
    element('a', {href: url, download: `${name}.${format}`}).click();
  }

  const guarded = (name, work) => work.catch(error => {
    errors.push(`${name}: ${error.message}`);
    console.error(name, error);
  });
  const chart_names = all('[data-chart]').map(holder => holder.dataset.chart);
  const update_all = () => Promise.all(chart_names.map(name => guarded(name, update(name))));

  let waiting = 0;
  function set_focus(solver) {
    state.focus = solver;
    for (const chip of all('.chip[data-solver]')) chip.classList.toggle('focus', chip.dataset.solver === solver);
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      for (const name in views) {
        const box = document.querySelector(`[data-chart="${name}"]`).getBoundingClientRect();
        if (box.bottom > 0 && box.top < innerHeight) views[name].signal('focus', solver).runAsync();
      }
    }, 40);
  }

  const tables = () => all('[data-table]').forEach(holder => { if (data.tables[holder.dataset.table]) table(holder, data, state); });

  // ---- chips and selectors ----

  function chips() {
    const holder = document.getElementById('chips');
    const button = (label, pick) => element('button', {className: 'chip', textContent: label, onclick: () => choose(new Set(pick))});
    holder.replaceChildren(button('all', names), button('none', []), ...styles(data.solvers, state.theme).filter(s => names.includes(s.name)).map(s => {
      const chip = element('button', {className: 'chip', ariaPressed: String(state.on.has(s.name)), title: data.solvers.find(x => x.name === s.name).method});
      chip.dataset.solver = s.name;
      chip.style.setProperty('--chip', s.color);
      chip.innerHTML = swatch(s);
      chip.append(s.name);
      chip.onclick = event => {
        const only = event.detail === 2 || event.altKey;
        const next = only ? new Set([s.name]) : new Set(state.on);
        if (!only && !next.delete(s.name)) next.add(s.name);
        choose(next);
      };
      chip.onpointerenter = () => set_focus(s.name);
      return chip;
    }));
    holder.onpointerleave = () => set_focus('');
  }
  function choose(on) {
    state.on = state.listed = on;
    chosen = [...on];
    write_hash();
    document.getElementById('left-out').textContent = '';
    for (const chip of all('.chip[data-solver]')) chip.ariaPressed = String(on.has(chip.dataset.solver));
    tables();
    return update_all();
  }

  // Choices in the address: #class=Coulomb&solvers=nsgs,cone
  function write_hash() {
    const words = [...state.problem_class === '0' ? [] : [`class=${encodeURIComponent(data.classes[state.problem_class].name)}`],
                   ...chosen ? [`solvers=${chosen.map(encodeURIComponent).join(',')}`] : []];
    location.replace(`#${words.join('&')}`);
  }
  function read_hash() {
    const asked = Object.fromEntries(location.hash.slice(1).split('&').map(word => word.split('=')));
    const wanted = asked.solvers?.split(',').map(decodeURIComponent);
    if (wanted) state.listed = new Set(chosen = everybody.filter(name => wanted.includes(name)));
    return Math.max(0, data.classes.findIndex(part => asked.class !== undefined && part.name === decodeURIComponent(asked.class)));
  }

  const options = {
    problem_class: () => data.classes.map((part, k) => [k, part.name]),
    family: () => drawn_families().map(f => [f, f]),
    problem: () => {
      const runs = all_rows(data, 'work-precision').filter(row => row.family === state.family);
      const problems = [...new Set(runs.filter(row => row.level === 'run' && row.drawn === 'ok').map(row => row.problem))];
      return [['', `median over ${problems.length}`], ...problems.map(p => [p, p])];
    },
    time: () => all_rows(data, 'work-precision').some(row => row.prepare > 0)
      ? [['whole', 'of the whole solve'], ['own', 'without bringing the problem into the method\'s form']] : [['whole', '']],
    group: () => [['', 'all families'], ...data.families.map(f => [f, f])],
    level: () => data.levels.map(level => [level, scientific(level)]),
    trace: () => distinct('convergence', 'problem').map(p => [p, p]),
    measure: () => Object.entries(measures).map(([key, label]) => [key, label]),
    sweep: () => distinct('scaling', 'family').map(f => [f, f]),
    size_family: () => speed_families(data).map(f => [f, f]),
  };
  function selectors() {
    for (const select of all('select[data-state]')) {
      const key = select.dataset.state;
      const list = options[key]();
      select.replaceChildren(...list.map(([value, label]) => element('option', {value, textContent: label})));
      select.value = state[key];
      select.closest('label').hidden = list.length < 2;
      select.onchange = () => {
        state[key] = key === 'level' ? Number(select.value) : select.value;
        if (key === 'family') state.problem = '';
        if (key === 'problem_class') {
          show_class(Number(select.value));
          write_hash();
        }
        selectors();
        tables();
        update_all();
      };
    }
  }

  async function set_theme(theme) {
    state.theme = theme;
    document.documentElement.dataset.theme = theme;
    document.getElementById('theme').textContent = theme === 'dark' ? 'light' : 'dark';
    chips();
    tables();
    for (const name of Object.keys(views)) await guarded(name, draw(name));
  }

  // ---- single runs of a large run ----

  function single_runs() {
    const section = document.getElementById('single');
    if (!data.single) return section.remove();
    const [family, problem] = section.querySelectorAll('select');
    const holder = section.querySelector('.table');
    const loaded = {};
    const show = () => {
      const [name, script] = data.single[family.value][problem.value];
      const runs = loaded[script]?.[name];
      if (!runs) {
        holder.replaceChildren(element('p', {className: 'reason', textContent: 'loading ...'}));
        const missing = () => holder.replaceChildren(element('p', {className: 'reason', textContent: `runs/${script}.js is not beside this page.`}));
        return document.body.append(element('script', {src: `runs/${script}.js`, onload: show, onerror: missing}));
      }
      const text = value => value === null ? '' : typeof value === 'number' ? scientific(value) : value;
      const head = element('tr', {}, ...['solver', 'tolerance', 'claimed', 'verified', 'error', 'time [s]', 'iterations', 'command']
        .map(label => element('th', {textContent: label})));
      holder.replaceChildren(element('div', {className: 'scroll'}, element('table', {}, element('thead', {}, head), element('tbody', {},
        ...runs.map(row => element('tr', {}, ...row.map((value, i) => element('td', {textContent: i === 6 ? value : text(value)}))))))));
    };
    globalThis.zwang_runs = (script, runs) => { loaded[script] = runs; };
    const list = () => problem.replaceChildren(...data.single[family.value].map(([name], i) => element('option', {value: i, textContent: name})));
    family.replaceChildren(...Object.keys(data.single).map(name => element('option', {value: name, textContent: name})));
    family.onchange = () => { list(); show(); };
    problem.onchange = show;
    list();
  }

  // ---- start ----

  single_runs();
  document.title = data.title;
  document.querySelector('h1').textContent = data.title;
  const sentences = data.headline.map(line => element('p', {textContent: typeset(line), className: /and (was|were) wrong/.test(line) ? 'alarm' : ''}));
  document.getElementById('headline').append(...sentences.slice(0, 2));
  if (sentences.length > 2) document.getElementById('headline').append(element('details', {}, element('summary', {textContent: 'More about this run'}), ...sentences.slice(2)));
  document.getElementById('claims').before(document.getElementById(data.opening));
  for (const section of all('main > section[data-short]')) {
    const holder = section.querySelector('[data-table]');
    const needed = section.dataset.needs ?? (section.querySelector('[data-chart]') ? undefined : holder?.dataset.table);
    if (needed && ![data, ...data.classes].some(part => part.tables[needed])) section.remove();
  }
  document.querySelector('nav').append(...all('main > section[data-short]').map(s => element('a', {href: `#${s.id}`, textContent: s.dataset.short})));
  const notes = document.getElementById('notes');
  notes.append(...data.notes.map(note => element('li', {textContent: note})));
  if (!data.notes.length) notes.replaceWith(element('p', {className: 'reason', textContent: 'The run holds no notes.'}));
  document.getElementById('theme').onclick = () => set_theme(state.theme === 'dark' ? 'light' : 'dark');
  show_class(read_hash());
  selectors();
  set_theme(state.theme);

  // Charts are drawn when they come into view.
  const seen = new IntersectionObserver(entries => {
    for (const entry of entries) if (entry.isIntersecting) show(entry.target);
  }, {rootMargin: '400px'});
  function show(holder) {
    seen.unobserve(holder);
    if (holder.dataset.seen) return Promise.resolve();
    holder.dataset.seen = 'yes';
    return guarded(holder.dataset.chart, draw(holder.dataset.chart));
  }
  all('[data-chart]').forEach(holder => seen.observe(holder));
  let width = innerWidth;
  addEventListener('resize', () => {
    if (Math.abs(innerWidth - width) < 40) return;
    width = innerWidth;
    for (const name of ['work-precision', 'families', 'sweep', 'speed-ratios', 'speed-exponents']) if (views[name]) guarded(name, draw(name));
  });

  // For tests and the curious: everything drawn at once, and what is on the page.
  globalThis.zwang_page = {state, views, errors, choose, set_theme, draw_all: () => Promise.all(all('[data-chart]').map(show))};
})();
